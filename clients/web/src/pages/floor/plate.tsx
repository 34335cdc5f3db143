// SPDX-License-Identifier: Apache-2.0
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import type { RigInfo } from '../../generated/dts/v1/control_pb';
import { Quality } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import type { Colours } from '../../parts/canvas';
import { colours, openSurface } from '../../parts/canvas';
import { Button } from '../../parts/controls';
import { useIsOld } from '../../parts/live';
import { fixed } from '../../parts/numbers';
import { PatientButton } from '../../parts/patient_button';
import { qualityWords } from '../../parts/quality';
import { strings } from '../../strings';
import type { Ellipse } from './ellipse';
import type { LiveFloor, Now } from './live_floor';
import { windowName } from './live_floor';
import type { Frame } from './plate_picture';
import { drawCop, drawGrid, drawLabels, drawPlate, toX, toY } from './plate_picture';
import type { View } from './view';
import { nextView } from './view';

const words = strings.floor.picture;
const mostInsetPx = 150;
const marginFactor = 1.08;

const describe = ({ mlMm, apMm, loadKg }: Now): string => {
  const load = fixed(loadKg, 0);
  if (Number.isNaN(mlMm)) return words.nobody(load);
  const across = mlMm >= 0 ? words.right(fixed(mlMm, 1)) : words.left(fixed(-mlMm, 1));
  const along = apMm >= 0 ? words.front(fixed(apMm, 1)) : words.back(fixed(-apMm, 1));
  return words.described(across, along, load);
};

const ofSensor = Quality.RAIL | Quality.STUCK | Quality.OUT_OF_RANGE | Quality.ROTATION | Quality.SUBSTITUTED | Quality.UNTARED;

/** Returns the index of the sensor within 24 px (a finger's width) of a point, or -1. */
const sensorAt = (frame: Frame, rig: RigInfo, x: number, y: number): number =>
  rig.sensors.findIndex((sensor) => Math.hypot(toX(frame, sensor.xMm - rig.plateAMm / 2) - x, toY(frame, sensor.yMm - rig.plateBMm / 2) - y) < 24);

interface Canvases {
  /** Plate, grid and labels: redrawn only when they change. */
  readonly ground: HTMLCanvasElement;
  /** Layer of what moves: redrawn often. */
  readonly top: HTMLCanvasElement;
}

/** Draws into the inset the part of the plate that the large picture shows, and the centre of the ellipse. */
const drawInset = (context: CanvasRenderingContext2D, frame: Frame, view: View, ellipse: Ellipse, present: Colours): void => {
  const side = (view.spanMm / frame.view.spanMm) * frame.width;
  context.strokeStyle = present.ink;
  context.lineWidth = 1.5;
  context.strokeRect(toX(frame, view.x - view.spanMm / 2), toY(frame, view.y + view.spanMm / 2), side, side);
  context.fillStyle = present.vermillion;
  context.beginPath();
  context.arc(toX(frame, ellipse.centreX), toY(frame, ellipse.centreY), 4, 0, 2 * Math.PI);
  context.fill();
};

/** Draws until it is released; calls `isZoomed` for every frame. */
const openPicture = (canvases: Canvases, link: Link, rig: RigInfo, floor: LiveFloor, isZoomed: () => boolean) => {
  const whole: View = { x: 0, y: 0, spanMm: marginFactor * Math.max(rig.plateAMm, rig.plateBMm) };
  let view = whole;
  let groundShows = '';
  const ground = openSurface(canvases.ground, () => (groundShows = ''));
  const top = openSurface(canvases.top, () => paint());
  const mainFrame = (): Frame => ({ left: 0, top: 0, width: top.width, height: top.height, view });
  const insetFrame = (): Frame => {
    const side = Math.min(mostInsetPx, top.width / 4);
    return { left: top.width - side - 12, top: 12, width: side, height: side, view: whole };
  };
  const paintGround = (ellipseName: string, present: Colours): void => {
    const wanted = [view.x, view.y, view.spanMm, ellipseName, present.paper, floor.sensorQuality.join()].join(' ');
    if (wanted === groundShows || ground.width === 0) return;
    groundShows = wanted;
    const { context } = ground;
    context.clearRect(0, 0, ground.width, ground.height);
    drawPlate(context, mainFrame(), rig, floor, present);
    drawGrid(context, mainFrame(), present);
    drawLabels(context, mainFrame(), ellipseName, present);
    if (view === whole) return;
    const inset = insetFrame();
    context.fillStyle = present.paper;
    context.fillRect(inset.left, inset.top, inset.width, inset.height);
    drawPlate(context, inset, rig, floor, present);
  };
  const paint = (): void => {
    if (top.width === 0 || top.height === 0) return;
    const ellipse = (floor.quality & Quality.NO_CONTACT) !== 0 ? undefined : floor.ellipse.peek();
    const shown = floor.sway.peek();
    const name = ellipse === undefined || shown === undefined ? '' : words.ellipse(windowName(shown.sway, strings.floor.windows));
    const present = colours().peek();
    view = isZoomed() ? nextView(view, ellipse, whole) : whole;
    paintGround(name, present);
    top.context.clearRect(0, 0, top.width, top.height);
    drawCop(top.context, mainFrame(), floor, ellipse, present);
    if (view !== whole && ellipse !== undefined) drawInset(top.context, insetFrame(), view, ellipse, present);
  };
  const stop = link.onPaint(paint);
  return {
    frame: mainFrame,
    release: () => {
      stop();
      ground.release();
      top.release();
    },
  };
};

interface PlateProps {
  link: Link;
  rig: RigInfo;
  floor: LiveFloor;
  /** The subject sees the COP on the patient screen. */
  hasFeedback: boolean;
}

export const Plate = ({ link, rig, floor, hasFeedback }: PlateProps): JSX.Element => {
  const ground = useRef<HTMLCanvasElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const picture = useRef<ReturnType<typeof openPicture>>();
  const isZoomed = useSignal(true);
  const pointed = useSignal(-1);
  useEffect(() => {
    const opened = openPicture({ ground: ground.current!, top: canvas.current! }, link, rig, floor, () => isZoomed.peek());
    picture.current = opened;
    return opened.release;
  }, [link, floor, rig.name]);
  const point = (event: MouseEvent): void => {
    if (picture.current !== undefined) pointed.value = sensorAt(picture.current.frame(), rig, event.offsetX, event.offsetY);
  };
  const isOld = useIsOld(link, rig.name).value;
  const now = floor.now.value; // renders four times a second, for the label
  const sensor = rig.sensors[pointed.value];
  return (
    <div class="plate">
      <canvas ref={ground} aria-hidden="true" />
      <canvas
        ref={canvas}
        role="img"
        aria-label={isOld ? strings.common.data.noData : describe(now)}
        data-testid="plate"
        data-ml-mm={now.mlMm.toFixed(2)}
        data-ap-mm={now.apMm.toFixed(2)}
        onMouseMove={point}
        onMouseLeave={() => (pointed.value = -1)}
      />
      <div class="plate-corner">
        {hasFeedback && (
          <span class="plate-note" data-testid="feedback-note">
            {strings.patient.feedbackNote}
          </span>
        )}
        <div class="row">
          {!link.me.value.isFleet && <PatientButton rig={rig.name} />}
          <Button
            label={isZoomed.value ? words.wholePlate : words.zoom}
            testId="zoom"
            onClick={() => (isZoomed.value = !isZoomed.value)}
          />
        </div>
      </div>
      {sensor !== undefined && (
        <div class="plate-sensor" data-testid="sensor-text">
          {words.sensor(sensor.label, fixed(floor.deflectionMm[pointed.value], 3), qualityWords((floor.sensorQuality[pointed.value] ?? 0) & ofSensor).join(', '))}
        </div>
      )}
    </div>
  );
};
