// SPDX-License-Identifier: Apache-2.0
import type { Surroundings } from './gateway_link';

/** Returns the real browser, connected to the gateway that served this page. */
export const thisBrowser = (): Surroundings => ({
  openSocket: () => new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`, 'dts.v1'),
  fetch: (...request) => fetch(...request),
  requestFrame: (callback) => void requestAnimationFrame(callback),
  isHidden: () => document.visibilityState === 'hidden',
  onVisibility: (handler) => document.addEventListener('visibilitychange', handler),
});
