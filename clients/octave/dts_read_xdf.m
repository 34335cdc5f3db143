function recording = dts_read_xdf(file)
% DTS_READ_XDF  Loads a recording of dtsd (XDF 1.0) in Octave 7 or MATLAB R2016b, and newer versions.
%
%   recording = dts_read_xdf('20261121T144525Z-floor-1.xdf')
%   cop = recording.streams.cop;
%   plot(cop.time_s - cop.time_s(1), cop.values(:, 2))
%
% recording.streams.NAME has for each stream "RIG/NAME" with numbers:
%   name           'floor/cop'
%   channels       1 x C cell array of texts: {'ml_mm', 'ap_mm', 'load_n'}
%   units          1 x C cell array of texts: {'mm', 'mm', 'N'}
%   rate_hz        scans per second; 0: irregular
%   delay_s        delay of the filters, in seconds
%   values         N x C array, of the class in the file (single, double, int32, ...); undefined values are NaN
%   time_s         N x 1 double: CLOCK_MONOTONIC of the daemon's computer, in seconds, the same for all rigs
%   stamp_s        N x 1 double: as in the file, in seconds of the device's clock
%   clock_offsets  K x 2 double: stamp, and the seconds to add there; time_s is interpolated between them
%   segment, scan  N x 1 double: number of the segment (from 0), and index of the scan in its segment (from 0)
%   gaps           rows before which scans are missing, as indices into values
%
% recording.events is a 1 x E array of structs in order of time:
%   rig, kind      'floor', and 'marker', 'segment', 'trial', 'session', 'trigger', ...
%   time_s, stamp_s, segment, scan   as above; the scan is one of the stream raw
%   text           text of a marker; empty for other events
%   json           the whole event; jsondecode(json) is a struct with the fields of dts.v1.Event
%
% recording.facts is a containers.Map of texts: recording.facts('subject'), 'session_id', 'protocol', 'part', ...
% recording.damage says why the file is damaged or incomplete; empty: no damage. Everything before the damage is read.
%
% Errors: 'dts:file' if the file cannot be read, 'dts:damaged' if it is not an XDF file. Needs memory for about three
% times the file.

% SPDX-License-Identifier: Apache-2.0
bytes = bytes_of(file);
if numel(bytes) < 4 || ~isequal(char(bytes(1:4).'), 'XDF:')
  error('dts:damaged', '%s is not an XDF file: XDF files start with ''XDF:''.', file);
end
[facts, streams, damage] = read_chunks(bytes);
if ~isobject(facts)
  error('dts:damaged', '%s has no readable file header: %s', file, damage);
end
if isempty(damage)
  damage = faults_of_footers({streams.footer});
end
events = events_of(streams);
streams = streams(~strcmp({streams.form}, 'string'));
table = segment_table(events, streams);
recording.facts = facts;
recording.streams = struct();
for k = 1:numel(streams)
  short = regexprep(streams(k).name, '^.*/', '');
  field = matlab.lang.makeUniqueStrings(matlab.lang.makeValidName(short), fieldnames(recording.streams));
  recording.streams.(field) = placed(streams(k), table);
end
recording.events = with_places(events, table);
recording.damage = damage;
end

function bytes = bytes_of(file)
[~, ~, endian] = computer();
if endian ~= 'L'
  error('dts:file', 'This computer is big-endian: dts_read_xdf reads files on little-endian computers only.');
end
[id, problem] = fopen(file, 'r');
if id < 0
  error('dts:file', 'Cannot read %s: %s', file, problem);
end
bytes = fread(id, Inf, '*uint8');
fclose(id);
end

% Chunk: [bytes of length: 1, 4, 8][length of tag and content][tag, u16][content].
function [facts, streams, damage] = read_chunks(bytes)
facts = [];
streams = new_streams();
numbers = [];                                  % of the streams, as in the file
owner = zeros(1, 1024);                        % of each samples chunk: index of its stream
stamps = cell(1, 1024);
values = cell(1, 1024);
count = 0;
damage = '';
at = 5;
try
  while at <= numel(bytes)
    begin = at;
    [size_of_chunk, at] = length_at(bytes, at);
    last = at + size_of_chunk - 1;
    if size_of_chunk < 2 || last > numel(bytes)
      error('dts:damaged', 'the chunk is torn');
    end
    tag = double(typecast(bytes(at:at + 1), 'uint16'));
    content = bytes(at + 2:last);
    at = last + 1;
    if isobject(facts) == (tag == 1)
      error('dts:damaged', 'a file starts with one file header');
    end
    if tag == 1
      facts = facts_of(text_of(content));
    end
    if ~any(tag == [2 3 4 6])
      continue
    end
    number = double(typecast(content(1:4), 'uint32'));
    content = content(5:end);
    k = find(numbers == number, 1);
    if isempty(k) ~= (tag == 2)
      error('dts:damaged', 'stream %d has no header, or a second one', number);
    end
    switch tag
      case 2
        streams(end + 1) = stream_of(text_of(content));
        numbers(end + 1) = number;
      case 3
        [chunk_stamps, chunk_values] = samples_of(content, streams(k));
        count = count + 1;
        if count > numel(owner)                % doubles: appending one by one would copy everything each time
          owner(2 * count) = 0;
          stamps{2 * count} = [];
          values{2 * count} = [];
        end
        owner(count) = k;
        stamps{count} = chunk_stamps;
        values{count} = chunk_values;
      case 4
        streams(k).clock_offsets(end + 1, :) = typecast(content(1:16), 'double').';
      case 6
        streams(k).footer = facts_of(text_of(content));
    end
  end
catch problem
  damage = sprintf('damaged at byte %d: %s', begin - 1, problem.message);
end
for k = 1:numel(streams)
  mine = find(owner(1:count) == k);
  streams(k).values = vertcat(streams(k).values, values{mine});
  streams(k).stamp_s = counted_on(vertcat(zeros(0, 1), stamps{mine}), streams(k));
  streams(k).time_s = on_host(streams(k).stamp_s, streams(k).clock_offsets);
end
end

function [number, at] = length_at(bytes, at)
width = bytes(at);
types = {'uint8', 'uint32', 'uint64'};
type = types([1 4 8] == width);
if isempty(type)
  error('dts:damaged', 'a length has neither 1, 4 nor 8 bytes');
end
number = double(typecast(bytes(at + 1:at + double(width)), type{1}));
at = at + 1 + double(width);
end

function streams = new_streams()
streams = struct('name', {}, 'channels', {}, 'units', {}, 'rate_hz', {}, 'delay_s', {}, 'values', {}, 'time_s', {}, ...
                 'stamp_s', {}, 'clock_offsets', {}, 'form', {}, 'type', {}, 'width', {}, 'rate', {}, 'footer', {});
end

function stream = stream_of(xml)
forms = {'int8', 'int16', 'int32', 'int64', 'float32', 'double64', 'string'};
types = {'int8', 'int16', 'int32', 'int64', 'single', 'double', ''};
widths = [1 2 4 8 4 8 2];                       % bytes; of a text at least
form = element(xml, 'channel_format');
which = find(strcmp(forms, form));
count = str2double(element(xml, 'channel_count'));
if isempty(which) || ~(count >= 1 && count <= 4096)
  error('dts:damaged', 'a stream has the channel_format ''%s'' and %g channels', form, count);
end
stream = new_streams();
stream(1).name = element(xml, 'name');
stream.form = form;
stream.type = types{which};
stream.width = widths(which);
channels = regexp(xml, '<channel>(.*?)</channel>', 'tokens');
stream.channels = repmat({''}, 1, count);
stream.units = repmat({''}, 1, count);
for k = 1:min(count, numel(channels))
  stream.channels{k} = element(channels{k}{1}, 'label');
  stream.units{k} = element(channels{k}{1}, 'unit');
end
if strcmp(form, 'string')
  stream.values = cell(0, count);
else
  stream.values = zeros(0, count, stream.type);
end
stream.clock_offsets = zeros(0, 2);
stream.delay_s = str2double(['0' element(xml, 'delay_ns')]) * 1e-9;
stream.rate = rate_of(xml);
stream.rate_hz = 0;
if ~isempty(stream.rate)
  stream.rate_hz = stream.rate(1) / stream.rate(2);
end
end

% Returns the rate as numerator and denominator. Files of other programs have only nominal_srate. Empty: irregular.
function rate = rate_of(xml)
nominal_hz = str2double(['0' element(xml, 'nominal_srate')]);
if nominal_hz == 0
  rate = [];
  return
end
exact = regexp(xml, '<rate numerator="(\d+)" denominator="(\d+)"', 'tokens', 'once');
if isempty(exact)
  rate = [round(nominal_hz * 1e6), 1e6];
else
  rate = str2double(exact);
end
if ~all(rate >= 1 & rate <= 1e12)
  error('dts:damaged', 'a stream has an impossible rate');
end
rate = rate / gcd(rate(1), rate(2));
end

% Samples: [bytes of count][count], then per sample [0 or 8][time stamp, f64, if 8][value]...
function [stamps, values] = samples_of(content, stream)
[count, at] = length_at(content, 1);
channels = numel(stream.channels);
row = 1 + channels * stream.width;             % bytes of a sample without stamp
if count * row > numel(content)
  error('dts:damaged', '%d samples are declared, more than the chunk has room for', count);
end
stamps = NaN(count, 1);
if strcmp(stream.form, 'string')
  values = cell(count, channels);
  for k = 1:count
    [stamps(k), at] = stamp_at(content, at);
    for channel = 1:channels
      [bytes, at] = length_at(content, at);
      values{k, channel} = text_of(content(at:at + bytes - 1));
      at = at + bytes;
    end
  end
  check_end(content, at);
  return
end
content = content(at:end);
if count == 0 || numel(content) ~= count * row + 8 * (content(1) == 8)
  % Another layout than dtsd writes: every sample has a stamp of its own, or some have one.
  raw = zeros(row - 1, count, 'uint8');
  at = 1;
  for k = 1:count
    [stamps(k), at] = stamp_at(content, at);
    raw(:, k) = content(at:at + row - 2);
    at = at + row - 1;
  end
  check_end(content, at);
else
  if content(1) == 8
    stamps(1) = typecast(content(2:9), 'double');
    content(2:9) = [];
  end
  raw = reshape(content, row, count);
  if any(raw(1, 2:end))
    error('dts:damaged', 'a sample has an impossible time stamp');
  end
  raw(1, :) = [];
end
values = reshape(typecast(raw(:), stream.type), channels, count).';
end

function check_end(content, at)
if at ~= numel(content) + 1
  error('dts:damaged', 'bytes are left over after the samples');
end
end

function [stamp_s, at] = stamp_at(content, at)
stamp_s = NaN;
if content(at) == 8
  stamp_s = typecast(content(at + 1:at + 8), 'double');
elseif content(at) ~= 0
  error('dts:damaged', 'a time stamp has neither 0 nor 8 bytes');
end
at = at + 1 + double(content(at));
end

% A sample without a stamp (NaN) gets its time from the last stamp and the rate.
function stamp_s = counted_on(stamps, stream)
index = (1:numel(stamps)).';
known = [0; find(~isnan(stamps))];           % 0: no stamp yet
last = cumsum(~isnan(stamps));
base = [0; stamps(known(2:end))];
since = index - known(last + 1);
stamp_s = base(last + 1);
if ~isempty(stream.rate)
  stamp_s = stamp_s + since * stream.rate(2) / stream.rate(1);
end
end

% Maps stamps to the clock of the host. dtsd measures offsets every 5 s; between them, this function interpolates.
function time_s = on_host(stamp_s, offsets)
offsets = sortrows(offsets(all(isfinite(offsets), 2), :), 1);
if isempty(offsets)
  time_s = stamp_s;
  return
end
after = count_up_to(offsets(:, 1), stamp_s);
before = max(min(after, size(offsets, 1) - 1), 1);
slopes = [diff(offsets(:, 2)) ./ diff(offsets(:, 1)); 0];
added = slopes(before) .* (stamp_s - offsets(before, 1)) + offsets(before, 2);
added(after == 0) = offsets(1, 2);
added(after == size(offsets, 1)) = offsets(end, 2);
time_s = stamp_s + added;
end

% Returns for each value how many of the sorted starts are not greater.
function counts = count_up_to(starts, values)
[~, order] = sort([starts(:); values(:)]);    % stable: a start precedes an equal value
is_start = order <= numel(starts);
passed = cumsum(is_start);
counts = zeros(numel(values), 1);
counts(order(~is_start) - numel(starts)) = passed(~is_start);
end

function events = events_of(streams)
events = struct('rig', {}, 'kind', {}, 'time_s', {}, 'stamp_s', {}, 'segment', {}, 'scan', {}, 'text', {}, 'json', {});
for stream = streams(strcmp({streams.form}, 'string'))
  rig = regexprep(stream.name, '/.*$', '');
  for k = 1:numel(stream.stamp_s)
    for text = stream.values(k, :)
      event = event_of(text{1});
      event.rig = rig;
      event.time_s = stream.time_s(k);
      event.stamp_s = stream.stamp_s(k);
      events(end + 1) = orderfields(event, events);
    end
  end
end
if ~isempty(events)
  [~, order] = sort([events.time_s]);
  events = events(order);
end
end

% A text that is not an event of dtsd is a marker.
function event = event_of(text)
event = struct('rig', '', 'kind', 'marker', 'time_s', NaN, 'stamp_s', NaN, 'segment', NaN, 'scan', NaN, ...
               'text', text, 'json', text);
try
  fields = jsondecode(text);
catch
  return
end
if ~isstruct(fields) || ~isscalar(fields)
  return
end
names = fieldnames(fields);
body = setdiff(names, {'instance_id', 'segment', 'scan', 'host_time_ns'});
if isfield(fields, 'event') && ischar(fields.event)     % dtsd 0.1: one flat object
  event.kind = fields.event;
  body = fields;
elseif numel(body) == 1 && isstruct(fields.(body{1}))
  kinds = containers.Map({'movement', 'trial_result', 'segment_start'}, {'class', 'result', 'segment'});
  event.kind = body{1};
  if isKey(kinds, event.kind)
    event.kind = kinds(event.kind);
  end
  body = fields.(body{1});
else
  return
end
event.segment = whole(fields, 'segment');
event.scan = whole(fields, 'scan');
event.text = '';
if strcmp(event.kind, 'marker') && isfield(body, 'text')
  event.text = body.text;
end
end

% JSON of protobuf has numbers of 64 bits as texts, and leaves out zeros.
function number = whole(fields, name)
number = 0;
if isfield(fields, name)
  number = fields.(name);
  if ischar(number)
    number = str2double(number);
  end
end
end

% Returns where the segments start: from the events of dtsd, otherwise from the stamps of the stream raw or of the fastest.
function table = segment_table(events, streams)
table.starts = zeros(0, 3);                    % stamp of the start, number of the segment, stamp of its scan 0
table.rate_hz = 0;
table.has_events = false;
streams = streams([streams.rate_hz] > 0);
if isempty(streams)
  return
end
[~, k] = max([streams.rate_hz]);
raw = find(~cellfun(@isempty, regexp({streams.name}, '(^|/)raw$', 'once')), 1);
if ~isempty(raw)
  k = raw;
end
table.rate_hz = streams(k).rate_hz;
for event = events(strcmp({events.kind}, 'segment'))
  table.starts(end + 1, :) = [event.stamp_s, event.segment, event.stamp_s - event.scan / table.rate_hz];
end
table.has_events = ~isempty(table.starts);
if ~table.has_events
  firsts = streams(k).stamp_s(breaks_of(streams(k).stamp_s, table.rate_hz));
  table.starts = [firsts, (0:numel(firsts) - 1).', firsts];
end
table.starts = sortrows(table.starts);
end

% Returns whether each sample starts a segment: its stamp is off by more than half a scan from its neighbour's.
function breaks = breaks_of(stamp_s, rate_hz)
breaks = [true(min(numel(stamp_s), 1), 1); abs(diff(stamp_s) - 1 / rate_hz) > 0.5 / rate_hz];
end

function [segment, scan] = places(stamp_s, rate_hz, table)
tolerance_s = 0.5 / rate_hz;
if table.has_events
  tolerance_s = 0.5 / table.rate_hz;           % a start is the stamp of a scan of the stream raw
end
row = max(count_up_to(table.starts(:, 1), stamp_s + tolerance_s), 1);
segment = table.starts(row, 2);
scan = max(round((stamp_s - table.starts(row, 3)) * rate_hz), 0);
end

function stream = placed(stream, table)
rate_hz = stream.rate_hz;
if rate_hz == 0
  rate_hz = table.rate_hz;
end
count = numel(stream.stamp_s);
if stream.rate_hz > 0 && ~table.has_events
  breaks = breaks_of(stream.stamp_s, rate_hz);
  first = find(breaks);
  stream.segment = cumsum(breaks) - 1;
  stream.scan = (1:count).' - first(stream.segment + 1);
elseif ~isempty(table.starts)
  [stream.segment, stream.scan] = places(stream.stamp_s, rate_hz, table);
else
  stream.segment = zeros(count, 1);
  stream.scan = zeros(count, 1);
end
if strcmp(stream.form, 'int8') && ~isempty(regexp(stream.name, '(^|/)quality$', 'once'))
  stream.values = reshape(typecast(stream.values(:), 'uint8'), size(stream.values));  % bits
end
stream.gaps = zeros(0, 1);
if stream.rate_hz > 0
  stream.gaps = find(diff(stream.segment) ~= 0 | diff(stream.scan) ~= 1) + 1;
end
stream = rmfield(stream, {'form', 'type', 'width', 'rate', 'footer'});
end

% Events of other programs have no segment and no scan: their stamps give them.
function events = with_places(events, table)
for k = find(isnan([events.scan]))
  events(k).segment = 0;
  events(k).scan = 0;
  if ~isempty(table.starts)
    [events(k).segment, events(k).scan] = places(events(k).stamp_s, table.rate_hz, table);
  end
end
end

function damage = faults_of_footers(footers)
is_closed = cellfun(@isobject, footers);
problems = {};
if ~all(is_closed)
  problems{end + 1} = 'no footer: the file was not closed';
end
for facts = footers(is_closed)
  if isKey(facts{1}, 'incomplete')
    problems{end + 1} = ['incomplete: ' facts{1}('incomplete')];
  end
  if isKey(facts{1}, 'recovered')
    problems{end + 1} = ['recovered, at most ' facts{1}('lost_s_at_most') ' s lost'];
  end
end
[~, first] = unique(problems, 'first');
problems = problems(sort(first));
damage = strjoin(problems, '; ');
end

function text = text_of(bytes)
text = native2unicode(bytes(:).', 'UTF-8');
end

% Returns the text of the first element of this name. In XML, '<' never occurs in a text.
function text = element(xml, name)
text = '';
found = regexp(xml, ['<' name '>([^<]*)</' name '>'], 'tokens', 'once');
if ~isempty(found)
  text = strtrim(unescaped(found{1}));
end
end

function facts = facts_of(xml)
facts = containers.Map('KeyType', 'char', 'ValueType', 'any');
found = regexp(xml, '<fact name="([^"]*)">([^<]*)</fact>', 'tokens');
for k = 1:numel(found)
  facts(unescaped(found{k}{1})) = unescaped(found{k}{2});
end
end

function text = unescaped(text)
for code = [9 10 13]
  text = strrep(text, sprintf('&#%d;', code), char(code));
end
text = strrep(strrep(strrep(strrep(text, '&lt;', '<'), '&gt;', '>'), '&quot;', '"'), '&apos;', '''');
text = strrep(text, '&amp;', '&');
end
