// SPDX-License-Identifier: Apache-2.0
// All clinics, those with problems first.
import type { JSX } from 'preact';

import type { Link } from '../../link/types';
import { Notice } from '../../parts/controls';
import { whole } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Clinic, Clinics } from './asking';
import { usePolled } from './asking';
import { agoText, backlogText, diskText, versionText, wrongTexts } from './wrong';

const words = strings.fleet.clinics;

export const ClinicState = ({ clinic }: { clinic: Clinic }): JSX.Element => {
  if (clinic.is_revoked) return <span class="fleet-revoked">{words.revoked}</span>;
  const texts = wrongTexts(clinic);
  if (texts.length === 0) {
    return (
      <span class="fleet-well">
        <span aria-hidden="true">●</span> {words.allWell}
      </span>
    );
  }
  return (
    <ul class="fleet-wrong" data-testid="wrong">
      {texts.map((text) => (
        <li key={text}>
          <span aria-hidden="true">▲</span> {text}
        </li>
      ))}
    </ul>
  );
};

const Row = ({ clinic }: { clinic: Clinic }): JSX.Element => {
  const { heads } = words;
  const present = clinic.rigs.filter((rig) => rig.is_present);
  const inSession = present.filter((rig) => rig.session_state === 'running' || rig.session_state === 'settling');
  return (
    <tr data-testid="clinic-row" data-clinic={clinic.name} data-wrong={clinic.wrong.join(' ')}>
      <th scope="row">
        <a class="sessions-link" href={`#/clinics/${clinic.name}`}>
          {clinic.title}
        </a>
        <div class="sessions-note">{clinic.name}</div>
      </th>
      <td data-label={heads.state}>
        <ClinicState clinic={clinic} />
      </td>
      <td data-label={heads.rigs}>{words.rigs(whole(present.length), whole(inSession.length))}</td>
      <td data-label={heads.backlog}>{backlogText(clinic)}</td>
      <td data-label={heads.beat}>{agoText(clinic.beat_age_s)}</td>
      <td data-label={heads.disk}>{diskText(clinic)}</td>
      <td data-label={heads.version}>{versionText(clinic)}</td>
    </tr>
  );
};

export const ClinicsPage = ({ link }: { link: Link }): JSX.Element => {
  const { answer, error } = usePolled<Clinics>(link, 'clinics').value;
  const { heads } = words;
  const clinics = answer?.clinics ?? [];
  return (
    <div class="column">
      <h1>{words.title}</h1>
      {error !== undefined && <Notice kind="error" what={error.message} hint={error.hint} testId="fleet-error" />}
      {answer === undefined && error === undefined && <p>{words.asking}</p>}
      {answer !== undefined && clinics.length === 0 && (
        <p class="empty" data-testid="no-clinics">
          {words.none}
        </p>
      )}
      {clinics.length > 0 && <p data-testid="clinic-count">{words.count(whole(clinics.length), whole(clinics.filter(({ wrong }) => wrong.length > 0).length))}</p>}
      {clinics.length > 0 && (
        <table class="sessions-table stack" data-testid="clinic-table">
          <thead>
            <tr>
              <th>{heads.clinic}</th>
              <th>{heads.state}</th>
              <th>{heads.rigs}</th>
              <th>{heads.backlog}</th>
              <th>{heads.beat}</th>
              <th>{heads.disk}</th>
              <th>{heads.version}</th>
            </tr>
          </thead>
          <tbody>
            {clinics.map((clinic) => (
              <Row key={clinic.name} clinic={clinic} />
            ))}
          </tbody>
        </table>
      )}
    </div>
  );
};
