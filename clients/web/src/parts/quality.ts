// SPDX-License-Identifier: Apache-2.0
import { strings } from '../strings';

/** Returns the words for bits of Quality; none if there is no doubt. */
export const qualityWords = (bits: number): string[] =>
  Object.entries(strings.common.quality)
    .filter(([bit]) => (bits & Number(bit)) !== 0)
    .map(([, word]) => word);
