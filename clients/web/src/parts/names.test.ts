// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { beforeEach, expect, test, vi } from 'vitest';

import { ProtocolInfoSchema, SessionRecordSchema } from '../generated/dts/v1/sessions_pb';
import { choiceName, inLanguage, asSentence, conditionName, isLabel, labelRule, protocolName, protocols, sessionTitle, targetName } from './names';

beforeEach(() => {
  protocols.value = [create(ProtocolInfoSchema, { name: 'romberg', title: "Romberg's test", conditions: [{ name: 'eyes-open', title: 'Eyes open, two feet' }, { name: '150', title: '150 % of arm length', targetPercent: 150 }] })];
});

test.each([
  ['romberg', "Romberg's test"],
  ['my_own-protocol', 'My own protocol'],
  ['', ''],
])('protocolName.%j is %j', (name, expected) => {
  expect(protocolName(name)).toBe(expected);
});

test.each([
  ['romberg', 'eyes-open', 'Eyes open, two feet'],
  ['romberg', 'eyes-closed', 'Eyes closed'], // of an older version of the protocol
  ['gone', 'eyes-open', 'Eyes open'],
])('conditionName.Of %j: %j is %j', (protocol, condition, expected) => {
  expect(conditionName(protocol, condition)).toBe(expected);
});

test.each([
  ['150', '150 %'],
  ['eyes-open', 'Eyes open, two feet'],
])('targetName.%j is %j', (condition, expected) => {
  expect(targetName('romberg', condition)).toBe(expected);
});

const started = (year: number): bigint => BigInt(new Date(year, 10, 23, 12).getTime()) * 1_000_000n;

test('sessionTitle.Names subject, protocol and day, the year only if it is another one', () => {
  vi.useFakeTimers({ now: new Date(2026, 11, 1) });
  const record = (subject: string, year: number) => create(SessionRecordSchema, { subject, protocol: 'romberg', startedUtcNs: started(year) });

  const titles = [record('P017', 2026), record('', 2026), record('P017', 2025)].map(sessionTitle);
  vi.useRealTimers();

  expect(titles[0]).toMatch(/^P017, Romberg's test, (23 Nov|Nov 23)$/);
  expect(titles[1]).toMatch(/^No subject ID, Romberg's test, /);
  expect(titles[2]).toMatch(/2025/);
});

test.each([
  ["tare rejected: the plate of rig 'floor' is loaded", "Tare rejected: the plate of rig 'floor' is loaded"],
  ['see dtsctl session list', 'See dtsctl session list'],
  ['dtsctl tare --rig chair', 'dtsctl tare --rig chair'],
  ['', ''],
])('asSentence.%j is %j', (message, expected) => {
  expect(asSentence(message)).toBe(expected);
});

test.each([
  ['dtsd was too busy: analyse the recording with dtslab sway', 'dtsd war zu beschäftigt: die Aufzeichnung mit dtslab sway auswerten'],
  ['dtsd was too busy for the results; compute them again from the file', 'dtsd war zu beschäftigt für die Ergebnisse; sie aus der Datei neu berechnen'],
  ['dtsd is writing its catalogue again, because a subject was erased', 'dtsd schreibt seinen Katalog neu, weil eine Person endgültig gelöscht wurde'],
  ['dtsd is making repaired copies of recordings', 'dtsd erstellt reparierte Kopien von Aufzeichnungen'],
  ['dtsd is stopping: it continues the erasure when it starts again', 'dtsd wird beendet: Es setzt das endgültige Löschen beim nächsten Start fort'],
  ['dtsctl tare --rig chair', 'dtsctl tare --rig chair'], // a command to type
])('asSentence.In German %j is %j', async (message, expected) => {
  vi.resetModules();
  vi.stubGlobal('localStorage', { getItem: () => 'de' });
  const inGerman = await import('./names');
  vi.unstubAllGlobals();

  expect(inGerman.asSentence(message)).toBe(expected);
});

test.each([
  ['[A-Z0-9]{1,8}', 'AB12', true],
  ['[A-Z0-9]{1,8}', 'Anna Schmidt', false],
  [String.raw`[^=+@<>\-\p{Z}][^<>\p{Z}]*( [^<>\p{Lu}\p{Z}]*)*`, 'дитина 2', true], // as the daemon's default
  [String.raw`[^=+@<>\-\p{Z}][^<>\p{Z}]*( [^<>\p{Lu}\p{Z}]*)*`, 'Анна Шмидт', false],
  ['a|b', 'ab', false], // the whole text, not a part of it
  ['[A-Z0-9]{1,8}', '', true], // no label
  ['[', 'anything', true], // the daemon decides
])('isLabel.By the rule %j, %j: %s', (pattern, text, expected) => {
  labelRule.value = { hint: '', pattern };

  expect(isLabel(text)).toBe(expected);
});

test('names.A protocol is shown in the language of the reader, and what its file does not translate in English', () => {
  const german = { language: 'de' };
  const protocol = create(ProtocolInfoSchema, {
    title: 'Reaching task',
    sentence: 'Reaches to targets',
    translations: [{ ...german, title: 'Reichaufgabe' }],
    conditions: [{ name: 'max', title: 'Maximum reach', translations: [{ ...german, title: 'Größte Reichweite' }] }],
    fields: [{ name: 'side', label: 'Reaching arm', choices: ['left', 'right'], translations: [{ ...german, label: 'Reicharm', choices: ['links', 'rechts'] }] }],
  });
  const { title, sentence, conditions, fields } = inLanguage(protocol, 'de');
  expect([title, sentence, conditions[0]?.title, fields[0]?.label, fields[0]?.choices]).toEqual(['Reichaufgabe', 'Reaches to targets', 'Größte Reichweite', 'Reicharm', ['left', 'right']]);
  expect([choiceName(fields[0]!, 'right', 'de'), choiceName(fields[0]!, 'right', 'en')]).toEqual(['rechts', 'right']);
  expect(inLanguage(protocol, 'en').title).toBe('Reaching task');
});
