// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { daemonMessages } from './de/daemon';
import { translatorOf } from './messages';

const german = translatorOf(daemonMessages);

test.each([
  ["no rig named 'hall'", 'kein Messplatz heißt „hall“'],
  ["rig 'floor' already has session 20261127-floor-1 (running)", 'Messplatz „floor“ hat schon Untersuchung 20261127-floor-1 (laufend)'],
  ["protocol 'romberg' is for a floor, and rig 'chair' is a chair", 'Art des Protokolls „romberg“: Bodenplattform; Art des Messplatzes „chair“: Stuhl'],
  ["field 'age_years' is out of range; field 'sex' is not one of its choices", 'Angabe „age_years“ liegt außerhalb des Bereichs; Angabe „sex“ steht nicht zur Auswahl'],
  ['this command needs the role operator; local has viewer', 'dieser Befehl braucht die Rolle Bedienung; local hat Ansicht'],
  ['start one: dtsctl session start --rig floor --protocol NAME', 'eine starten: dtsctl session start --rig floor --protocol NAME'],
  ['trial 3 is under way (measuring)', 'Durchgang 3 läuft (bei der Messung)'],
  ['the session is settling, not running', 'die Untersuchung läuft nicht, sie ist in der Beruhigung'],
  ['this subject has no planned session 4', 'diese Person hat keine geplante Untersuchung 4'],
  ['a sentence that nobody has translated', 'a sentence that nobody has translated'],
])('messages.%s', (english, translated) => {
  expect(german(english)).toBe(translated);
});

test('messages.Every translation has as many places as its English sentence, and no sentence is listed twice', () => {
  const places = (text: string): number => text.split('{}').length;
  expect(daemonMessages.filter(([english, translated]) => places(english) !== places(translated))).toEqual([]);
  expect(new Set(daemonMessages.map(([english]) => english)).size).toBe(daemonMessages.length);
});
