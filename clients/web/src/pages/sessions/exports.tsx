// SPDX-License-Identifier: Apache-2.0
// Downloads that show their size before the user starts them.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { PartState } from '../../generated/dts/v1/sessions_pb';
import { Button, Notice } from '../../parts/controls';
import { bytes, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { archiveUrl, responseError, useAsked } from './asking';

// An export must be made before its size is known. That takes about a second for a short recording; a long one is made only on request.
const madeUnaskedBytes = 100_000_000n;

const sizeOf = (response: Response): number => Number(response.headers.get('Content-Length') ?? Number.NaN);

/** Returns the size in bytes, or NaN if the gateway does not know it. Never downloads the export itself. */
export const askSize = async (url: string, signal: AbortSignal): Promise<number> => {
  const head = await fetch(url, { method: 'HEAD', signal });
  if (head.ok) return sizeOf(head);
  // A response to HEAD has no body with the error.
  const response = await fetch(url, { signal });
  if (!response.ok) throw await responseError(response);
  await response.body?.cancel(); // the export is available after all
  return sizeOf(response);
};

/** A download that is made before it is offered: on request, or at once if `isPrepared`. */
export const Download = (props: { label: string; url: string; isPrepared: boolean; testId: string }): JSX.Element => {
  const { label, url, testId } = props;
  const isWanted = useSignal(props.isPrepared);
  const { error, answer } = useAsked(isWanted.value ? url : '', (signal) => askSize(url, signal)).value;
  const { prepare, preparing, sized } = strings.sessions.exports;
  if (error !== undefined) return <Notice kind="plain" what={error.message} hint={error.hint} testId={`${testId}-error`} />;
  if (answer !== undefined) {
    return (
      <a class="button" href={url} download data-testid={testId}>
        {Number.isFinite(answer) ? sized(label, bytes(answer)) : label}
      </a>
    );
  }
  return isWanted.value ? (
    <span class="exports-wait" data-testid={`${testId}-preparing`}>
      {preparing(label)}
    </span>
  ) : (
    <Button label={prepare(label)} onClick={() => (isWanted.value = true)} testId={`${testId}-prepare`} />
  );
};

export const Exports = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { csv, bids, xdf } = strings.sessions.exports;
  const files = session.parts.filter((part) => part.state !== PartState.MISSING);
  const isPrepared = files.reduce((sum, part) => sum + part.bytes, 0n) <= madeUnaskedBytes;
  const url = (path: string): string => archiveUrl(session.sessionId, `export/${path}`);
  return (
    <div class="row">
      {files.map(({ part }) => (
        <Download key={part} label={xdf(whole(part))} url={url(`xdf/${part}`)} isPrepared testId={`export-xdf-${part}`} />
      ))}
      <Download label={csv} url={url('csv')} isPrepared={isPrepared} testId="export-csv" />
      <Download label={bids} url={url('bids')} isPrepared={isPrepared} testId="export-bids" />
    </div>
  );
};
