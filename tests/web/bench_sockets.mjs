// SPDX-License-Identifier: Apache-2.0
// Sockets without a picture that confirm each frame at once: the largest load for a gateway.

/** Runs in the page. Writes the bytes itself; field numbers are those of gateway.proto. */
const openInPage = (topics, count) => {
  const lengthDelimited = (field, bytes) => [(field << 3) | 2, bytes.length, ...bytes];
  const subscribe = lengthDelimited(1, topics.flatMap((topic) => lengthDelimited(1, [...new TextEncoder().encode(topic)])));
  window.framesSoFar = 0;
  const afterVarint = (bytes, at) => {
    while (bytes[at] >= 0x80) at += 1;
    return at + 1;
  };
  const take = (socket, bytes) => {
    if (bytes[0] !== 0x12) return; // FromGateway.frame
    const number = afterVarint(bytes, 1); // Frame.number, its first field
    window.framesSoFar += 1;
    socket.send(new Uint8Array(lengthDelimited(2, [...bytes.subarray(number, afterVarint(bytes, number + 1))])));
  };
  for (let index = 0; index < count; index += 1) {
    const socket = new WebSocket(`ws://${location.host}/ws`, 'dts.v1');
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => socket.send(new Uint8Array(subscribe));
    socket.onmessage = ({ data }) => take(socket, new Uint8Array(data));
  }
};

/** Opens the sockets. Returns a function that returns the number of frames received so far by all of them. */
export const openSockets = async (page, topics, count) => {
  await page.evaluate(openInPage, topics, count);
  return () => page.evaluate(() => window.framesSoFar);
};
