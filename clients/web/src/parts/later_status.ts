// SPDX-License-Identifier: Apache-2.0

// A status may be made just before an event and arrive after it.
const statusLagNs = 1_000_000_000n;

/** Returns whether a status, made at a host time, includes an event. If it contradicts that event, a later event was lost. */
export const includesEvent = (madeNs: bigint, eventNs: bigint): boolean => madeNs - eventNs > statusLagNs;
