// SPDX-License-Identifier: Apache-2.0
// Draws the plate, its sensors and the centre of pressure, with the same scale in both directions.
import { Quality } from '../../generated/dts/v1/stream_pb';
import type { RigInfo } from '../../generated/dts/v1/control_pb';
import type { Colours } from '../../parts/canvas';
import { fontFamily, roundLength } from '../../parts/canvas';
import { whole } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Ellipse } from './ellipse';
import type { LiveFloor } from './live_floor';
import { ap, ml, trailS } from './live_floor';
import type { View } from './view';

const words = strings.floor.picture;

/** The area of the canvas that shows `view`, in CSS pixels. */
export interface Frame {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
  readonly view: View;
}

export const scaleOf = (frame: Frame): number => Math.min(frame.width, frame.height) / frame.view.spanMm;
export const toX = (frame: Frame, mm: number): number => frame.left + frame.width / 2 + (mm - frame.view.x) * scaleOf(frame);
export const toY = (frame: Frame, mm: number): number => frame.top + frame.height / 2 - (mm - frame.view.y) * scaleOf(frame); // front is up

const clipped = (context: CanvasRenderingContext2D, frame: Frame, draw: () => void): void => {
  context.save();
  context.beginPath();
  context.rect(frame.left, frame.top, frame.width, frame.height);
  context.clip();
  draw();
  context.restore();
};

const dot = (context: CanvasRenderingContext2D, x: number, y: number, radius: number): void => {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
};

const badSensor = Quality.RAIL | Quality.STUCK | Quality.OUT_OF_RANGE | Quality.ROTATION | Quality.SUBSTITUTED;

/** Draws sensors as small dots. A faulty one gets a thick ring and a cross, so that colour is not the only sign. */
const drawSensors = (context: CanvasRenderingContext2D, frame: Frame, rig: RigInfo, floor: LiveFloor, colours: Colours): void => {
  rig.sensors.forEach((sensor, index) => {
    const [x, y] = [toX(frame, sensor.xMm - rig.plateAMm / 2), toY(frame, sensor.yMm - rig.plateBMm / 2)];
    const isBad = ((floor.sensorQuality[index] ?? 0) & badSensor) !== 0;
    context.fillStyle = colours.quiet;
    dot(context, x, y, 3);
    context.fill();
    context.strokeStyle = isBad ? colours.vermillion : colours.green;
    context.lineWidth = isBad ? 4 : 1.5;
    dot(context, x, y, 9);
    context.stroke();
    if (!isBad) return;
    context.beginPath();
    context.moveTo(x - 14, y - 14);
    context.lineTo(x + 14, y + 14);
    context.moveTo(x + 14, y - 14);
    context.lineTo(x - 14, y + 14);
    context.stroke();
  });
};

export const drawPlate = (context: CanvasRenderingContext2D, frame: Frame, rig: RigInfo, floor: LiveFloor, colours: Colours): void =>
  clipped(context, frame, () => {
    const [halfA, halfB] = [rig.plateAMm / 2, rig.plateBMm / 2];
    context.fillStyle = colours.raised;
    context.strokeStyle = colours.line;
    context.lineWidth = 2;
    context.beginPath();
    context.rect(toX(frame, -halfA), toY(frame, halfB), rig.plateAMm * scaleOf(frame), rig.plateBMm * scaleOf(frame));
    context.fill();
    context.stroke();
    drawSensors(context, frame, rig, floor, colours);
  });

/** Draws lines every 1, 2 or 5 times a power of ten mm; darker lines through the plate's centre. */
export const drawGrid = (context: CanvasRenderingContext2D, frame: Frame, colours: Colours): void =>
  clipped(context, frame, () => {
    const step = roundLength(frame.view.spanMm / 4);
    const [halfWide, halfHigh] = [frame.width / scaleOf(frame) / 2, frame.height / scaleOf(frame) / 2];
    const line = (isMiddle: boolean, x0: number, y0: number, x1: number, y1: number): void => {
      context.strokeStyle = isMiddle ? colours.line : colours.grid;
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.stroke();
    };
    context.lineWidth = 1;
    for (let x = Math.ceil((frame.view.x - halfWide) / step); x * step <= frame.view.x + halfWide; x += 1) {
      line(x === 0, toX(frame, x * step), frame.top, toX(frame, x * step), frame.top + frame.height);
    }
    for (let y = Math.ceil((frame.view.y - halfHigh) / step); y * step <= frame.view.y + halfHigh; y += 1) {
      line(y === 0, frame.left, toY(frame, y * step), frame.left + frame.width, toY(frame, y * step));
    }
  });

const shades = 5;

/** Draws the last five seconds, one shade per second. The line breaks at missing scans. */
const drawTrail = (context: CanvasRenderingContext2D, frame: Frame, floor: LiveFloor, colours: Colours): void => {
  const ring = floor.ring!;
  context.strokeStyle = colours.blue;
  context.lineWidth = 2.5;
  context.lineJoin = 'bevel'; // looks the same as round joins and takes half the time
  for (let shade = 0; shade < shades; shade += 1) {
    const from = ring.indexAt(floor.newestMs - (1000 * trailS * (shades - shade)) / shades);
    const to = Math.min(ring.indexAt(floor.newestMs - (1000 * trailS * (shades - shade - 1)) / shades) + 1, ring.length);
    context.globalAlpha = (shade + 1) / shades;
    context.beginPath();
    let isDown = false;
    for (let index = from; index < to; index += 1) {
      const x = ring.value(ml, index);
      if (Number.isNaN(x)) isDown = false;
      else if (isDown) context.lineTo(toX(frame, x), toY(frame, ring.value(ap, index)));
      else {
        context.moveTo(toX(frame, x), toY(frame, ring.value(ap, index)));
        isDown = true;
      }
    }
    context.stroke();
  }
  context.globalAlpha = 1;
};

const drawEllipse = (context: CanvasRenderingContext2D, frame: Frame, ellipse: Ellipse, colours: Colours): void => {
  const scale = scaleOf(frame);
  context.save();
  context.translate(toX(frame, ellipse.centreX), toY(frame, ellipse.centreY));
  context.rotate(-ellipse.angleRad); // y points up on the plate and down on the canvas
  context.strokeStyle = colours.orange;
  context.lineWidth = 2.5;
  context.beginPath();
  context.ellipse(0, 0, ellipse.long * scale, ellipse.short * scale, 0, 0, 2 * Math.PI);
  context.stroke();
  context.lineWidth = 1;
  context.setLineDash([5, 4]);
  context.beginPath();
  context.moveTo(-ellipse.long * scale, 0);
  context.lineTo(ellipse.long * scale, 0);
  context.moveTo(0, -ellipse.short * scale);
  context.lineTo(0, ellipse.short * scale);
  context.stroke();
  context.restore();
};

const drawCross = (context: CanvasRenderingContext2D, x: number, y: number, colours: Colours): void => {
  context.strokeStyle = colours.ink;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x - 12, y);
  context.lineTo(x + 12, y);
  context.moveTo(x, y - 12);
  context.lineTo(x, y + 12);
  context.stroke();
};

/** Draws trail, ellipse with its centre, and dot. */
export const drawCop = (context: CanvasRenderingContext2D, frame: Frame, floor: LiveFloor, ellipse: Ellipse | undefined, colours: Colours): void => {
  const { ring } = floor;
  if (ring === undefined || ring.length === 0) return;
  clipped(context, frame, () => {
    drawTrail(context, frame, floor, colours);
    if (ellipse !== undefined) {
      drawEllipse(context, frame, ellipse, colours);
      drawCross(context, toX(frame, ellipse.centreX), toY(frame, ellipse.centreY), colours);
    }
    const [x, y] = [ring.value(ml, ring.length - 1), ring.value(ap, ring.length - 1)];
    if (Number.isNaN(x)) return;
    context.fillStyle = colours.vermillion;
    context.strokeStyle = colours.raised;
    context.lineWidth = 3;
    dot(context, toX(frame, x), toY(frame, y), 11);
    context.fill();
    context.stroke();
  });
};

const label = (context: CanvasRenderingContext2D, text: string, x: number, y: number, align: CanvasTextAlign, colours: Colours): void => {
  context.font = `16px ${fontFamily}`;
  context.textAlign = align;
  context.lineWidth = 5;
  context.strokeStyle = colours.paper; // a halo, so that lines do not cross the letters
  context.lineJoin = 'round';
  context.strokeText(text, x, y);
  context.fillStyle = colours.ink;
  context.fillText(text, x, y);
};

/** Draws directions, scale bar and the name of the ellipse; an empty name is not drawn. */
export const drawLabels = (context: CanvasRenderingContext2D, frame: Frame, ellipseName: string, colours: Colours): void => {
  const [middleX, middleY] = [frame.left + frame.width / 2, frame.top + frame.height / 2];
  const [right, bottom] = [frame.left + frame.width, frame.top + frame.height];
  label(context, words.axisFront, middleX, frame.top + 20, 'center', colours);
  label(context, words.axisBack, middleX, bottom - 10, 'center', colours);
  label(context, words.axisLeft, frame.left + 10, middleY, 'left', colours);
  label(context, words.axisRight, right - 10, middleY, 'right', colours);
  const barMm = roundLength(150 / scaleOf(frame));
  const barPixels = barMm * scaleOf(frame);
  context.fillStyle = colours.ink;
  context.fillRect(frame.left + 16, bottom - 20, barPixels, 5);
  label(context, words.scale(whole(barMm)), frame.left + 16, bottom - 28, 'left', colours);
  const below = frame.width < 600 ? 22 : 0; // on a phone "front" is in the same place
  if (ellipseName !== '') label(context, ellipseName, frame.left + 16, frame.top + 22 + below, 'left', colours);
};
