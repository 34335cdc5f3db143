// SPDX-License-Identifier: Apache-2.0
// Plain names for what the daemon names by a key: protocols, conditions, sessions.
import type { SessionRecord } from '../generated/dts/v1/sessions_pb';
import { strings } from '../strings';
import { day } from './numbers';

/** Turns a key into words: "eyes-closed-two-feet" becomes "eyes closed two feet". */
export const spoken = (key: string): string => key.replaceAll(/[-_]/g, ' ');

export const capitalised = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);

const programs = /^(dts|sudo|systemctl|journalctl|chmod|chown)/;

/** Writes a message of daemon or gateway as a sentence on the screen: with a capital, unless it begins with a command to type. */
export const asSentence = (message: string): string => (programs.test(message) ? message : capitalised(message));

/** "Quiet standing" for "quiet-standing"; a protocol of the user's own is shown by its own name. */
export const protocolName = (name: string): string => {
  const { protocols } = strings.common;
  const known = Object.hasOwn(protocols, name) ? protocols[name] : undefined;
  return known ?? capitalised(spoken(name));
};

/** "P017, Romberg, 23 Nov": what a person calls a session. The session ID is shown beside it. */
export const sessionTitle = ({ subject, protocol, startedUtcNs }: SessionRecord): string =>
  strings.sessions.titleOf(subject === '' ? strings.sessions.noSubject : subject, protocolName(protocol), day(startedUtcNs));
