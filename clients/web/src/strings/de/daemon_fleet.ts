// SPDX-License-Identifier: Apache-2.0
// The German of what the centre of a fleet says: its database, its link to a clinic, what a clinic rejects. See daemon.ts.
import type { Message } from '../messages';

export const fleetMessages: readonly Message[] = [
  // Requests for pages
  ["no clinic '{!}'", 'keine Klinik „{}“'],
  ['choose a clinic on the page Clinics', 'auf der Seite Kliniken eine auswählen'],
  ["'clinic' is not the name of a clinic", '„clinic“ ist nicht der Name einer Klinik'],
  ["'measure' is missing", '„measure“ fehlt'],
  ['choose a measure', 'eine Kenngröße auswählen'],
  ["'before' is not the 'next' of a page", '„before“ ist nicht das „next“ einer Seite'],
  ['load the first page again', 'die erste Seite neu laden'],
  ["'{!}' is too long", '„{}“ ist zu lang'],
  ['shorten it to {!} bytes', 'auf {} Bytes kürzen'],
  ["'{!}' is not a number that is allowed", '„{}“ ist keine erlaubte Zahl'],
  ['use {!} to {!}', '{} bis {} verwenden'],
  ['the address names no clinic', 'die Adresse nennt keine Klinik'],
  // Database
  ['the database of the centre does not answer', 'die Datenbank des Zentrums antwortet nicht'],
  ['check PostgreSQL on the computer of the centre', 'PostgreSQL auf dem Computer des Zentrums prüfen'],
  ['the database of the centre rejects the dashboard', 'die Datenbank des Zentrums lässt dts-fleet-gateway nicht zu'],
  ['the log of dts-fleet-gateway has the reason', 'der Grund steht im Log von dts-fleet-gateway'],
  ['the database of the centre needed too long', 'die Datenbank des Zentrums brauchte zu lange'],
  ['choose a shorter time or one clinic', 'eine kürzere Zeit oder eine einzelne Klinik auswählen'],
  ['too many pages are requested at once', 'zu viele Seiten werden gleichzeitig angefordert'],
  // Live data of a clinic
  ['the centre has no connection to nats-server', 'das Zentrum hat keine Verbindung zu nats-server'],
  ['the clinic is not connected to the centre', 'die Klinik ist nicht mit dem Zentrum verbunden'],
  ['the clinic sends no data', 'die Klinik sendet keine Daten'],
  ['the clinic reports more than {!} rigs', 'die Klinik meldet mehr als {} Messplätze'],
  ['the clinic reports more than {!} streams of a rig', 'die Klinik meldet mehr als {} Datenströme eines Messplatzes'],
  ['the clinic answers: {}', 'die Klinik antwortet: {}'],
  ['the clinic does not allow it', 'die Klinik erlaubt es nicht'],
  ['dtsd of the clinic does not run', 'dtsd der Klinik läuft nicht'],
  ['the clinic has no topic {!}', 'die Klinik hat kein Thema {}'],
  ['{!} others watch already', '{} andere sehen schon zu'],
];
