// SPDX-License-Identifier: Apache-2.0
// Messages of the daemon and the gateway. They arrive as English sentences, so a translation finds them by their fixed words.
import { daemonMessages } from './de/daemon';
import { language } from './language';

/**
 * An English message and its translation. "{}" stands for a text that is translated too, "{!}" for one that stays as it is: the name of a rig, a file.
 * A translation has a "{}" for each, in the same order. A name in single quotes stays as it is.
 */
export type Message = readonly [english: string, translated: string];

interface Pattern {
  readonly parts: readonly string[]; // around each place
  readonly isName: readonly boolean[]; // of each place: its text stays as it is
  readonly translated: string;
}

const mostDepth = 8;
const place = /\{!?\}/;
const fixedLetters = (parts: readonly string[]): number => parts.reduce((sum, part) => sum + (part.match(/[a-z]/gi)?.length ?? 0), 0);

/** Returns a function that translates a message. What the catalogue lacks stays English. */
export const translatorOf = (messages: readonly Message[]): ((message: string) => string) => {
  const whole = new Map(messages);
  const patterns: readonly Pattern[] = messages
    .map(([english, translated]) => ({ parts: english.split(place), places: english.match(new RegExp(place, 'g')) ?? [], translated }))
    .filter(({ places }) => places.length > 0)
    .sort((one, other) => fixedLetters(other.parts) - fixedLetters(one.parts)) // the closest one first
    .map(({ parts, places, translated }) => ({ parts, isName: places.map((one, index) => one === '{!}' || parts[index]!.endsWith("'")), translated }));

  /** Returns the texts for each place; nothing if the message is another one. */
  const filled = (message: string, parts: readonly string[]): readonly string[] | undefined => {
    const last = parts.at(-1)!;
    if (!message.startsWith(parts[0]!) || !message.endsWith(last)) return undefined;
    const found: string[] = [];
    let at = parts[0]!.length;
    for (const [index, part] of parts.slice(1).entries()) {
      const next = index + 2 === parts.length ? message.length - last.length : message.indexOf(part, at);
      if (next <= at) return undefined; // no text is empty
      const text = message.slice(at, next);
      if (parts[index]!.endsWith("'") && text.includes("'")) return undefined; // a name in quotes ends at the next one
      found.push(text);
      at = next + part.length;
    }
    return found;
  };

  const translate = (message: string, depth: number): string => {
    const known = whole.get(message);
    if (known !== undefined) return known;
    if (depth === mostDepth) return message;
    for (const { parts, isName, translated } of patterns) {
      const texts = filled(message, parts);
      if (texts !== undefined) {
        const rest = texts.map((text, index) => (isName[index] ? text : translate(text, depth + 1)));
        return translated.replaceAll('{}', () => rest.shift()!);
      }
    }
    return message;
  };
  return (message) => translate(message, 0);
};

/** Returns a message of the daemon or the gateway in the reader's language. */
export const inReadersLanguage: (message: string) => string = language === 'de' ? translatorOf(daemonMessages) : (message) => message;
