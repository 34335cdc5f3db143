// SPDX-License-Identifier: Apache-2.0
// Plain names for what the daemon names by a key: protocols, conditions, sessions.
import { signal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

import type { ProtocolField, ProtocolInfo, SessionRecord, Translation } from '../generated/dts/v1/sessions_pb';
import type { Link } from '../link/types';
import { strings } from '../strings';
import { language } from '../strings/language';
import { inReadersLanguage } from '../strings/messages';
import { day, whole } from './numbers';

type Translated = { readonly translations: readonly Translation[] };
const translationOf = ({ translations }: Translated, wanted: string): Partial<Translation> => translations.find((one) => one.language === wanted) ?? {};

/** Returns a protocol with its texts in a language; a text that its file does not translate stays English. Choices of fields stay: they are values. */
export const inLanguage = (protocol: ProtocolInfo, wanted: string): ProtocolInfo => {
  const { title, sentence } = translationOf(protocol, wanted);
  return {
    ...protocol,
    title: title || protocol.title,
    sentence: sentence || protocol.sentence,
    conditions: protocol.conditions.map((condition) => ({ ...condition, title: translationOf(condition, wanted).title || condition.title })),
    fields: protocol.fields.map((field) => {
      const { label, unit, help } = translationOf(field, wanted);
      return { ...field, label: label || field.label, unit: unit || field.unit, help: help || field.help };
    }),
  };
};

/** Returns what a form shows for a choice of a field, in the reader's language. */
export const choiceName = (field: ProtocolField, choice: string, wanted: string = language): string =>
  translationOf(field, wanted).choices?.[field.choices.indexOf(choice)] || choice;

/** The daemon's protocols in the reader's language; empty until it has answered. */
export const protocols = signal<readonly ProtocolInfo[]>([]);

/** The clinic's rule for labels and markers; empty until the daemon has answered. */
export const labelRule = signal<{ readonly hint: string; readonly pattern: string }>({ hint: '', pattern: '' });

/** Returns whether a label fits the clinic's rule. The daemon checks it again. */
export const isLabel = (text: string): boolean => {
  if (text === '' || labelRule.value.pattern === '') return true;
  try {
    return new RegExp(`^(?:${labelRule.value.pattern})$`, 'u').test(text);
  } catch {
    return true; // an expression that this browser cannot read
  }
};

/** Asks for the protocols after each new connection: a restarted daemon may have others. The shell calls it once for all pages. */
export const useProtocols = (link: Link): void => {
  const state = link.state.value;
  useEffect(() => {
    if (state !== 'up') return;
    link.send({ case: 'listProtocols', value: {} }).then(
      (answer) => {
        if (answer.case !== 'protocols') return;
        protocols.value = answer.value.protocols.map((one) => inLanguage(one, language));
        labelRule.value = { hint: answer.value.labelHint && asSentence(answer.value.labelHint), pattern: answer.value.labelPattern };
      },
      () => undefined, // the next connection asks again
    );
  }, [link, state]);
};

/** Turns a key into words: "eyes-closed-two-feet" becomes "eyes closed two feet". */
export const spoken = (key: string): string => key.replaceAll(/[-_]/g, ' ');

export const capitalised = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);

const programs = /^(dtsctl|dtslab|dts-[a-z]+|sudo|systemctl|journalctl|chmod|chown) /;

/** Writes a message of daemon or gateway as a sentence on the screen: in the reader's language, and with a capital, unless it begins with a command to type or with "dtsd". */
export const asSentence = (message: string): string => {
  if (programs.test(message)) return message;
  const text = inReadersLanguage(message);
  return text.startsWith('dtsd ') ? text : capitalised(text);
};

const protocolOf = (name: string): ProtocolInfo | undefined => protocols.value.find((one) => one.name === name);

/** "Romberg's test" for "romberg": the protocol's title. One that the daemon no longer has is shown by its own name. Reads a signal. */
export const protocolName = (name: string): string => protocolOf(name)?.title || capitalised(spoken(name));

/** "Eyes open" for the condition "eyes-open" of a protocol: its title. Reads a signal. */
export const conditionName = (protocol: string, condition: string): string =>
  protocolOf(protocol)?.conditions.find((one) => one.name === condition)?.title || capitalised(spoken(condition));

/** "150 %" of the arm's length for a target of the reaching task, in a table of targets; else the condition's title. Reads a signal. */
export const targetName = (protocol: string, condition: string): string => {
  const percent = protocolOf(protocol)?.conditions.find((one) => one.name === condition)?.targetPercent;
  return percent === undefined ? conditionName(protocol, condition) : `${whole(percent)} %`;
};

/** "P017, Romberg's test, 23 Nov": what a person calls a session. The session ID is shown beside it. */
export const sessionTitle = ({ subject, protocol, startedUtcNs }: Pick<SessionRecord, 'subject' | 'protocol' | 'startedUtcNs'>): string =>
  strings.sessions.titleOf(subject === '' ? strings.sessions.noSubject : subject, protocolName(protocol), day(startedUtcNs));
