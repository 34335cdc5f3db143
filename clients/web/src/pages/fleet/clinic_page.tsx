// SPDX-License-Identifier: Apache-2.0
// One clinic: what is wrong, its rigs, what it has not yet sent, what has arrived.
import type { JSX } from 'preact';
import { useMemo } from 'preact/hooks';

import type { Link } from '../../link/types';
import { Notice, Panel } from '../../parts/controls';
import { bytes, dateTime, duration, fixed, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Clinic, ClinicDetail, Rig } from './asking';
import { usePolled } from './asking';
import { ClinicState } from './clinics_page';
import { LinePlot } from './line_plot';
import { agoText, backlogText, diskText, timeText } from './wrong';

const words = strings.fleet.clinic;

const atMs = (ms: number | null): string => (ms === null ? strings.fleet.clinics.never : dateTime(BigInt(ms) * 1_000_000n));

const Facts = ({ clinic }: { clinic: Clinic }): JSX.Element => {
  const { facts } = words;
  const none = strings.common.undefinedValue;
  const offset = clinic.clock_offset_s === null ? none : `${fixed(clinic.clock_offset_s, 2)} s`;
  const entries: readonly (readonly [string, string])[] = [
    [facts.name, clinic.name],
    [facts.beat, agoText(clinic.beat_age_s)],
    [facts.backlog, backlogText(clinic)],
    [facts.oldest, timeText(clinic.backlog_age_s)],
    [facts.receipt, atMs(clinic.last_receipt_ms)],
    [facts.disk, diskText(clinic)],
    [facts.recordable, clinic.recordable_s === null ? none : duration(clinic.recordable_s)],
    [facts.clock, offset],
    [facts.forwarder, clinic.forwarder_version || none],
    [facts.daemon, clinic.daemon_version || none],
  ];
  return (
    <dl class="facts" data-testid="clinic-facts">
      {entries.map(([name, value]) => (
        <>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </>
      ))}
    </dl>
  );
};

const calibrationText = (rig: Rig): string =>
  rig.calibration === '' ? words.rigs.model : words.rigs.calibrated(rig.calibration, whole(Math.floor(rig.calibration_age_d ?? 0)));

const livePages = new Set(['floor', 'chair']);

const RigRow = ({ clinic, rig }: { clinic: Clinic; rig: Rig }): JSX.Element => {
  const { heads, devices } = words.rigs;
  const isInSession = rig.session_state === 'running' || rig.session_state === 'settling';
  return (
    <tr data-testid="rig-row" data-rig={rig.rig}>
      <th scope="row">
        {rig.rig}
        {rig.kind !== rig.rig && <div class="sessions-note">{rig.kind}</div>}
      </th>
      <td data-label={heads.device}>{rig.is_present ? (devices[rig.device] ?? rig.device) : words.rigs.notReported}</td>
      <td data-label={heads.session}>{isInSession ? words.rigs.inSession : words.rigs.noSession}</td>
      <td data-label={heads.rate} class="number">
        {fixed(rig.measured_rate_hz ?? rig.nominal_rate_hz, 1)}
      </td>
      <td data-label={heads.lost} class="number">
        {whole(rig.lost_scans)}
      </td>
      <td data-label={heads.calibration}>{calibrationText(rig)}</td>
      <td data-label={heads.live}>
        {rig.is_present && livePages.has(rig.kind) ? (
          <a class="sessions-link" href={`#/clinics/${clinic.name}/${rig.kind}/${encodeURIComponent(rig.rig)}`} data-testid={`watch-${rig.rig}`}>
            {words.rigs.watch(rig.rig)}
          </a>
        ) : (
          strings.common.undefinedValue
        )}
      </td>
    </tr>
  );
};

const Rigs = ({ clinic }: { clinic: Clinic }): JSX.Element => {
  const { head, none, heads } = words.rigs;
  return (
    <Panel title={head} testId="rigs">
      {clinic.rigs.length === 0 ? (
        <p>{none}</p>
      ) : (
        <table class="stack">
          <thead>
            <tr>
              <th>{heads.rig}</th>
              <th>{heads.device}</th>
              <th>{heads.session}</th>
              <th class="number">{heads.rate}</th>
              <th class="number">{heads.lost}</th>
              <th>{heads.calibration}</th>
              <th>{heads.live}</th>
            </tr>
          </thead>
          <tbody>
            {clinic.rigs.map((rig) => (
              <RigRow key={rig.rig} clinic={clinic} rig={rig} />
            ))}
          </tbody>
        </table>
      )}
    </Panel>
  );
};

const bytesPerGb = 1e9;

const History = ({ history }: { history: ClinicDetail['history'] }): JSX.Element => {
  const { head, none, label, unit } = words.history;
  const key = history.map((day) => `${day.day} ${day.largest_backlog_bytes}`).join(); // drawn again only if it changed
  const timesMs = useMemo(() => history.map(({ day }) => Date.parse(`${day}T12:00:00Z`)), [key]);
  const lines = useMemo(() => [{ name: head, values: history.map((day) => day.largest_backlog_bytes / bytesPerGb) }], [key]);
  const largest = Math.max(0, ...history.map((day) => day.largest_backlog_bytes));
  return (
    <Panel title={head} testId="history">
      {history.length === 0 ? (
        <p>{none}</p>
      ) : (
        <LinePlot timesMs={timesMs} lines={lines} unit={unit} label={label(whole(history.length), bytes(largest))} testId="history-plot" />
      )}
    </Panel>
  );
};

const Receipts = ({ receipts }: { receipts: ClinicDetail['receipts'] }): JSX.Element => {
  const { head, none, heads } = words.receipts;
  return (
    <Panel title={head} testId="receipts">
      {receipts.length === 0 ? (
        <p>{none}</p>
      ) : (
        <table class="stack">
          <thead>
            <tr>
              <th>{heads.session}</th>
              <th class="number">{heads.part}</th>
              <th class="number">{heads.size}</th>
              <th>{heads.stored}</th>
              <th>{heads.checksum}</th>
            </tr>
          </thead>
          <tbody>
            {receipts.map((receipt) => (
              <tr key={receipt.sha256}>
                <th scope="row">{receipt.session}</th>
                <td data-label={heads.part} class="number">
                  {whole(receipt.part)}
                </td>
                <td data-label={heads.size} class="number">
                  {bytes(receipt.bytes)}
                </td>
                <td data-label={heads.stored}>{atMs(receipt.stored_ms)}</td>
                <td data-label={heads.checksum} title={receipt.sha256}>
                  {receipt.sha256.slice(0, 12)} …
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </Panel>
  );
};

export const ClinicPage = ({ link, name }: { link: Link; name: string }): JSX.Element => {
  const { answer, error } = usePolled<ClinicDetail>(link, `clinics/${encodeURIComponent(name)}`).value;
  return (
    <div class="column">
      <p>
        <a class="sessions-link" href="#/clinics">
          {words.back}
        </a>
      </p>
      <h1 data-testid="clinic-title">{answer?.clinic.title ?? name}</h1>
      {error !== undefined && <Notice kind="error" what={error.message} hint={error.hint} testId="fleet-error" />}
      {answer === undefined && error === undefined && <p>{strings.fleet.clinics.asking}</p>}
      {answer !== undefined && (
        <>
          <ClinicState clinic={answer.clinic} />
          <Facts clinic={answer.clinic} />
          <p>
            <a class="sessions-link" href={`#/sessions/${answer.clinic.name}`}>
              {words.sessions}
            </a>
          </p>
          <Rigs clinic={answer.clinic} />
          <History history={answer.history} />
          <Receipts receipts={answer.receipts} />
        </>
      )}
    </div>
  );
};
