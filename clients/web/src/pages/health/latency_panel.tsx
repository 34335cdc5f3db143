// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { Link } from '../../link/types';
import { Panel } from '../../parts/controls';
import { fixed, percent, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { Facts } from './facts';
import { barEndsMs, mostMs } from './latency';
import { useAges } from './watch';

const height = 120;
const width = 40;

const Bar = ({ share, index }: { share: number; index: number }): JSX.Element => {
  const end = barEndsMs[index];
  const label = end === undefined ? strings.health.latency.more : whole(end);
  return (
    <g transform={`translate(${index * width} 0)`}>
      <rect class="latency-bar" x="3" y={height - share * height} width={width - 6} height={share * height} />
      <text x={width / 2} y={height + 20}>
        {label}
      </text>
    </g>
  );
};

const ageText = (ms: number): string => (ms === Number.POSITIVE_INFINITY ? `> ${whole(mostMs)} ms` : `${fixed(ms, 0)} ms`);

/** Latency from the newest scan of a block to its arrival in this tab; the picture follows with the next frame. */
export const LatencyPanel = ({ link }: { link: Link }): JSX.Element => {
  const ages = useAges(link).value;
  const { latency } = strings.health;
  const dropped = link.dropped.value;
  const median = ageText(ages.medianMs);
  const p95 = ageText(ages.p95Ms);
  const shares = ages.bars.map((share, index) => latency.bar(barEndsMs[index] === undefined ? latency.more : whole(barEndsMs[index]), percent(share)));
  return (
    <Panel title={latency.title} testId="latency">
      <p>{latency.sentence}</p>
      <svg
        class="latency-histogram"
        viewBox={`0 0 ${(barEndsMs.length + 1) * width} ${height + 30}`}
        role="img"
        aria-label={`${latency.description(median, p95)} ${shares.join(', ')}`}
      >
        {ages.bars.map((share, index) => (
          <Bar key={index} share={share} index={index} />
        ))}
        <line class="latency-axis" x1="0" y1={height} x2={(barEndsMs.length + 1) * width} y2={height} />
      </svg>
      <Facts
        facts={[
          { name: latency.median, value: median, testId: 'latency-median' },
          { name: latency.p95, value: p95, testId: 'latency-p95' },
          { name: latency.blocks, value: whole(ages.blocks) },
          { name: latency.clock, value: `± ${fixed(link.clockErrorMs.value, 1)} ms` },
          { name: latency.dropped, value: whole(dropped.scans), isDoubtful: dropped.scans > 0, testId: 'tab-dropped' },
        ]}
      />
    </Panel>
  );
};
