// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { Quality } from '../generated/dts/v1/stream_pb';
import { qualityWords } from './quality';

test('qualityWords.EveryBit has its own words', () => {
  const bits = Object.values(Quality).filter((bit): bit is Quality => typeof bit === 'number' && bit !== Quality.UNSPECIFIED);

  const words = bits.flatMap(qualityWords);

  expect(new Set(words).size).toBe(bits.length);
  expect(qualityWords(Quality.STUCK | Quality.UNTARED)).toEqual(['signal stuck', 'not tared']);
  expect(qualityWords(Quality.UNSPECIFIED)).toEqual([]);
});
