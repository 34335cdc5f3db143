// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren, JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import { colours, openSurface } from '../../parts/canvas';
import { Tile } from '../../parts/controls';
import { fixed } from '../../parts/numbers';
import { strings } from '../../strings';
import { DecisionTile } from './decision_tile';
import type { LiveFloor, Steadiness } from './live_floor';
import { windowName } from './live_floor';

const words = strings.floor;

const tiles = [
  { symbol: 'MVELO', label: words.tiles.velocity, unit: 'mm/s', digits: 1 },
  { symbol: 'PEA95_F', label: words.tiles.area, unit: 'mm²', digits: 0 },
  { symbol: 'RANGE_AP', label: words.tiles.rangeAp, unit: 'mm', digits: 1 },
  { symbol: 'RANGE_ML', label: words.tiles.rangeMl, unit: 'mm', digits: 1 },
] as const;

/** Draws the last minute as a thin line from 0 up. Decoration only: the number is beside it. */
const Spark = ({ values, version }: { values: readonly number[]; version: unknown }): JSX.Element => {
  const canvas = useRef<HTMLCanvasElement>(null);
  const present = colours().value;
  useEffect(() => {
    const draw = (): void => {
      const { context, width, height } = surface;
      context.clearRect(0, 0, width, height);
      const highest = Math.max(...values.filter((value) => !Number.isNaN(value)), 0);
      if (highest <= 0) return;
      context.strokeStyle = present.sky;
      context.lineWidth = 1.5;
      context.beginPath();
      values.forEach((value, index) => {
        const [x, y] = [(index * width) / Math.max(1, values.length - 1), height - 1 - (value / highest) * (height - 3)];
        if (index === 0) context.moveTo(x, y);
        else context.lineTo(x, y);
      });
      context.stroke();
    };
    const surface = openSurface(canvas.current!, draw);
    return surface.release;
  }, [values, version, present]);
  return <canvas ref={canvas} class="spark" aria-hidden="true" />;
};

export const noteOf = (steadiness: Steadiness | undefined): string | undefined => {
  if (steadiness === undefined) return undefined;
  const { isPreliminary, isValid } = steadiness.sway;
  const window = windowName(steadiness.sway, words.windows);
  const note = isPreliminary ? words.preliminary(window) : words.final(window);
  return isValid ? note : `${note}, ${words.invalid}`;
};

const noValues: readonly number[] = [];

/** `children`: another tile, which is not a measure of steadiness. */
export const SwayTiles = ({ floor, children }: { floor: LiveFloor; children: ComponentChildren }): JSX.Element => {
  const steadiness = floor.sway.value;
  const isFinal = steadiness !== undefined && !steadiness.sway.isPreliminary;
  return (
    <section class="sway-tiles" data-testid="sway" data-kind={steadiness === undefined ? 'none' : isFinal ? 'final' : 'preliminary'}>
      <p class={`sway-note${isFinal ? ' sway-final' : ''}`} data-testid="sway-note">
        {noteOf(steadiness) ?? words.noSway}
      </p>
      {tiles.map(({ symbol, label, unit, digits }) => (
        <div key={symbol} class={isFinal ? 'tile-final' : 'tile-preliminary'}>
          <Tile label={label} value={fixed(steadiness?.values.get(symbol), digits)} unit={unit} testId={`sway-${symbol}`} isLarge={symbol === 'MVELO'}>
            <Spark values={(steadiness === undefined ? undefined : floor.sparks.get(symbol)) ?? noValues} version={steadiness} />
          </Tile>
        </div>
      ))}
      {children}
      {steadiness?.sway.decision !== undefined && <DecisionTile decision={steadiness.sway.decision} />}
    </section>
  );
};
