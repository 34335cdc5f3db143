// SPDX-License-Identifier: Apache-2.0
import type { Surroundings } from './gateway_link';

/** Returns the real browser, connected to the gateway that served this page. `clinic`: whose rigs to watch, if the gateway serves a centre. */
export const thisBrowser = (clinic?: string): Surroundings => ({
  clinic,
  openSocket: () => {
    const query = clinic === undefined ? '' : `?clinic=${encodeURIComponent(clinic)}`;
    return new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws${query}`, 'dts.v1');
  },
  fetch: (...request) => fetch(...request),
  requestFrame: (callback) => void requestAnimationFrame(callback),
  isHidden: () => document.visibilityState === 'hidden',
  onVisibility: (handler) => {
    document.addEventListener('visibilitychange', handler);
    return () => document.removeEventListener('visibilitychange', handler);
  },
});
