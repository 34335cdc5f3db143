// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';

import type { Block } from '../../link/types';
import { Ghosts } from './ghosts';
import { newEnvelope, TransientRing } from './transient_ring';

const block = (firstScan: number, values: readonly number[], more: Partial<Block> = {}): Block =>
  ({
    firstScan,
    scanCount: values.length,
    columns: [Float32Array.from(values)],
    segment: 0,
    rateHz: 100,
    isNewSegment: false,
    missingScans: 0,
    ...more,
  }) as Block;

const ramp = (from: number, count: number): number[] => Array.from({ length: count }, (_, index) => from + index);

describe('TransientRing', () => {
  it('Decimated.KeepsEveryPeak', () => {
    const ring = new TransientRing(64);
    ring.push(block(0, [1, 9, 1, 1, -5, 1, 1, 1]));
    const envelope = newEnvelope(2);

    ring.decimate(0, 8, 2, envelope);

    expect([...envelope.low]).toEqual([1, -5]);
    expect([...envelope.high]).toEqual([9, 1]);
  });

  it('BeforeTheFirstAndAfterTheLastScan.IsNothing', () => {
    const ring = new TransientRing(64);
    ring.push(block(10, [3, 3]));
    const envelope = newEnvelope(4);

    ring.decimate(8, 16, 4, envelope);

    expect([...envelope.low]).toEqual([Number.NaN, 3, Number.NaN, Number.NaN]);
  });

  it('MissingScans.StayAHole', () => {
    const ring = new TransientRing(64);
    ring.push(block(0, [1, 1]));
    ring.push(block(4, [2]));

    expect([ring.at(1), ring.at(2), ring.at(3), ring.at(4)]).toEqual([1, Number.NaN, Number.NaN, 2]);
  });

  it('Full.ForgetsTheOldest', () => {
    const ring = new TransientRing(4);
    ring.push(block(0, ramp(0, 3)));
    ring.push(block(3, ramp(3, 3)));

    expect([ring.at(1), ring.at(2), ring.at(5)]).toEqual([Number.NaN, 2, 5]);
  });

  it.each([
    ['NewSegment', { segment: 1, isNewSegment: true }],
    ['RestartedDaemon', { isNewSegment: true }],
  ])('%s.BeginsAnew', (_, more) => {
    const ring = new TransientRing(64);
    ring.push(block(0, ramp(0, 8)));

    ring.push(block(0, [7], more));

    expect([ring.at(0), ring.at(1), ring.endScan]).toEqual([7, Number.NaN, 1]);
  });

  it('MeansAcrossAHole.AreNothing', () => {
    const ring = new TransientRing(64);
    ring.push(block(0, [1, 3, 5]));
    ring.push(block(4, [5, 5, 7]));

    expect([...ring.means(0, 2, 3)]).toEqual([2, Number.NaN, 5]);
  });
});

describe('Ghosts', () => {
  const ring = new TransientRing(1024);
  ring.push(block(0, ramp(0, 400)));
  const goAt = { segment: 0, scan: 200 };

  it('OfATarget.AreTheLastFive', () => {
    const ghosts = new Ghosts();
    ghosts.begin('s1');

    for (let trial = 1; trial <= 7; trial += 1) ghosts.keep(trial, '120', goAt, ring);

    expect(ghosts.of('120').map((ghost) => ghost.trial)).toEqual([3, 4, 5, 6, 7]);
    expect(ghosts.of('150')).toEqual([]);
    expect(ghosts.of('120')[0]?.values[0]).toBe(100); // one second before "Go"
  });

  it('OfAVoidTrial.AreDropped', () => {
    const ghosts = new Ghosts();
    ghosts.keep(1, '120', goAt, ring);
    ghosts.keep(2, '120', goAt, ring);

    ghosts.drop(2);

    expect(ghosts.of('120').map((ghost) => ghost.trial)).toEqual([1]);
  });

  it('OfAnotherSession.AreGone', () => {
    const ghosts = new Ghosts();
    ghosts.begin('s1');
    ghosts.keep(1, '120', goAt, ring);

    ghosts.begin('s2');

    expect(ghosts.of('120')).toEqual([]);
  });

  it('AcrossAGap.AreNotKept', () => {
    const ghosts = new Ghosts();

    ghosts.keep(1, '120', { segment: 1, scan: 200 }, ring);

    expect(ghosts.of('120')).toEqual([]);
  });
});
