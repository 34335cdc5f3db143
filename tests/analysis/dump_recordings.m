function dump_recordings(folder)
% Reads every *.xdf in a folder, and writes beside it what dts_read_xdf returns: numbers as their bytes, everything else as
% JSON in NAME.xdf.json. If a file cannot be read, the JSON is the message of the error.
% SPDX-License-Identifier: Apache-2.0
for file = dir(fullfile(folder, '*.xdf')).'
  path = fullfile(folder, file.name);
  try
    text = dump(path);
  catch problem
    text = jsonencode(problem.message);
  end
  out = fopen([path '.json'], 'w');
  fputs(out, text);
  fclose(out);
end
end

function text = dump(file)
recording = dts_read_xdf(file);
fields = fieldnames(recording.streams);
streams = cell(1, numel(fields));
for k = 1:numel(fields)
  stream = recording.streams.(fields{k});
  described = rmfield(stream, {'values', 'time_s', 'stamp_s', 'segment', 'scan', 'clock_offsets', 'gaps'});
  described.field = fields{k};
  described.class = class(stream.values);
  described.gaps = num2cell(stream.gaps);
  streams{k} = described;
  write(file, fields{k}, 'values', stream.values.');
  write(file, fields{k}, 'time_s', stream.time_s);
  write(file, fields{k}, 'stamp_s', stream.stamp_s);
  write(file, fields{k}, 'segment', stream.segment);
  write(file, fields{k}, 'scan', stream.scan);
end
names = keys(recording.facts);
facts = [names; values(recording.facts)];
text = jsonencode(struct('streams', {streams}, 'events', {num2cell(recording.events)}, 'facts', {facts(:)}, 'damage', recording.damage));
end

function write(file, stream, what, numbers)
out = fopen([file '.' stream '.' what], 'w');
fwrite(out, numbers, class(numbers));
fclose(out);
end
