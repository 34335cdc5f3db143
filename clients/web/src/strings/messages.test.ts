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
  ['the session is settling, not running', 'die Untersuchung läuft nicht, sie ist im Vorlauf'],
  ['this subject has no planned session 4', 'diese Person hat keine geplante Untersuchung 4'],
  ['stop it first: dtsctl session stop --rig floor', 'zuerst beenden: dtsctl session stop --rig floor'], // "floor" is a name here
  ["tare rejected: the plate of rig 'floor' is loaded", 'Tarieren abgelehnt: Die Platte des Messplatzes „floor“ ist belastet'],
  [
    'sensors that do not measure: w1, e2 (unchanged); n3 (at the end of the range): check plug, supply and distance to the plate',
    'Sensoren, die nicht messen: w1, e2 (unverändert); n3 (am Ende des Messbereichs): Stecker, Versorgung und Abstand zur Platte prüfen',
  ],
  [
    'cannot open sim:floor?seed=7: not plugged in (wait: the simulated device is plugged in again by itself)',
    'sim:floor?seed=7 lässt sich nicht öffnen: nicht eingesteckt (warten: Das simulierte Gerät wird von selbst wieder eingesteckt)',
  ],
  [
    'cannot open USB device 09db:0125 at /dev/bus/usb/001/004, serial 01AB: another program or rig is using it (close the other program, or the other rig, that uses it)',
    'USB-Gerät 09db:0125 an /dev/bus/usb/001/004, Seriennummer 01AB lässt sich nicht öffnen: ein anderes Programm oder ein anderer Messplatz benutzt es (das andere Programm oder den anderen Messplatz schließen, der es benutzt)',
  ],
  [
    'cannot open mcc:1608fs-plus: no such device is plugged in (check its cable and power; dtsd opens it as soon as it is plugged in)',
    'mcc:1608fs-plus lässt sich nicht öffnen: kein solches Gerät ist eingesteckt (Kabel und Stromversorgung prüfen; dtsd öffnet es, sobald es eingesteckt ist)',
  ],
  [
    'cannot open serial port /dev/ttyACM0: there is no such port (plug the board in; dtsctl device list shows the ports)',
    'serieller Anschluss /dev/ttyACM0 lässt sich nicht öffnen: diesen Anschluss gibt es nicht (die Platine einstecken; dtsctl device list zeigt die Anschlüsse)',
  ],
  ['LabJack U6: the reply to GetConfig has a wrong checksum', 'LabJack U6: die Antwort auf GetConfig hat eine falsche Prüfsumme'],
  ['the program board.py ended with exit status 1; dtsd opens it again by itself', 'das Programm board.py endete mit Status 1; dtsd öffnet es von selbst wieder'],
  ["cannot write '/srv/a.json': No space left on device", 'kann „/srv/a.json“ nicht schreiben: kein Platz auf dem Datenträger'],
  ['cannot synchronise /srv/a.xdf.part: Input/output error', 'kann /srv/a.xdf.part nicht auf den Datenträger schreiben: Ein-/Ausgabefehler'],
  [
    '/srv has room for only 12 min of recording; make room, or set [storage] directory (or DTSD_STATE_DIR) to another disk',
    '/srv hat nur Platz für 12 min Aufzeichnung; Platz schaffen, oder [storage] directory (oder DTSD_STATE_DIR) auf einen anderen Datenträger legen',
  ],
  [
    'thread acquire: SCHED_FIFO rejected: Operation not permitted; scans may arrive late under load (priorities are 1 to 99; grant LimitRTPRIO or rtprio in limits.conf)',
    'Thread acquire: SCHED_FIFO abgelehnt: nicht erlaubt; unter Last können Abtastungen verspätet ankommen (Prioritäten sind 1 bis 99; LimitRTPRIO setzen oder rtprio in limits.conf)',
  ],
  [
    "rig 'floor': the calibration of 2026-11-02 was measured with sim:chair, not with sim:floor; calibrate again: dtsctl calibrate cop --rig floor",
    'Messplatz „floor“: Kalibrierung vom 2026-11-02 mit sim:chair gemessen, nicht mit sim:floor; neu kalibrieren: dtsctl calibrate cop --rig floor',
  ],
  [
    "rig 'chair': the calibration of 2026-11-02 names no DAQ: it was computed from a model or from a table of loads; calibrate again: dtsctl calibrate cop --rig chair",
    'Messplatz „chair“: Kalibrierung vom 2026-11-02 nennt kein Messgerät: aus einem Modell oder einer Tabelle von Lasten berechnet; neu kalibrieren: dtsctl calibrate cop --rig chair',
  ],
  [
    "rig 'floor': sensor curves (w1, w2) were measured at other sensors (w2, w1); name the file of each sensor in the rig file, or calibrate again: dtsctl calibrate sensor --rig floor --sensor all",
    'Messplatz „floor“: Sensorkennlinien (w1, w2) an anderen Sensoren gemessen (w2, w1); in der Messplatzdatei die Datei jedes Sensors angeben oder neu kalibrieren: dtsctl calibrate sensor --rig floor --sensor all',
  ],
  [
    "rig 'floor': sensor curves (w4) were measured with LabJack U6 11, not with USB-1408FS 11; calibrate again: dtsctl calibrate sensor --rig floor --sensor all",
    'Messplatz „floor“: Sensorkennlinien (w4) mit LabJack U6 11 gemessen, nicht mit USB-1408FS 11; neu kalibrieren: dtsctl calibrate sensor --rig floor --sensor all',
  ],
  [
    "rig 'floor': sensor curves (w2) are of rig 'left'; calibrate again: dtsctl calibrate sensor --rig floor --sensor all",
    'Messplatz „floor“: Sensorkennlinien (w2) gehören zu Messplatz „left“; neu kalibrieren: dtsctl calibrate sensor --rig floor --sensor all',
  ],
  [
    "rig 'floor': sensor curves (w3, w4) were measured on channels (ch2, ch3), not on (ch3, ch2); check the wiring and channel in the rig file, or calibrate again: dtsctl calibrate sensor --rig floor --sensor all",
    'Messplatz „floor“: Sensorkennlinien (w3, w4) an den Kanälen (ch2, ch3) gemessen, nicht an (ch3, ch2); Verkabelung und channel in der Messplatzdatei prüfen oder neu kalibrieren: dtsctl calibrate sensor --rig floor --sensor all',
  ],
  [
    "rig 'floor': sensor curves (w1) were measured with USB-1408FS 11, and the device is 12, another unit of the same model; compare a known distance, or calibrate again: dtsctl calibrate sensor --rig floor --sensor all",
    'Messplatz „floor“: Sensorkennlinien (w1) mit USB-1408FS 11 gemessen, und das Gerät ist 12, ein anderes desselben Modells; einen bekannten Abstand vergleichen oder neu kalibrieren: dtsctl calibrate sensor --rig floor --sensor all',
  ],
  ['session chair has no recording', 'Untersuchung chair hat keine Aufzeichnung'],
  ['a sentence that nobody has translated', 'a sentence that nobody has translated'],
])('messages.%s', (english, translated) => {
  expect(german(english)).toBe(translated);
});

test('messages.Every translation has as many places as its English sentence, and no sentence is listed twice', () => {
  const places = (text: string): number => text.split(/\{!?\}/).length;
  expect(daemonMessages.filter(([english, translated]) => places(english) !== places(translated))).toEqual([]);
  expect(new Set(daemonMessages.map(([english]) => english)).size).toBe(daemonMessages.length);
});
