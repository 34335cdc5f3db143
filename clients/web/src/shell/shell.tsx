// SPDX-License-Identifier: Apache-2.0
// The frame of every page: tabs, status line, user, theme, list of keys.
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import { Role } from '../generated/dts/v1/options_pb';
import type { Link } from '../link/types';
import { Button, Notice, Panel, PassingNotice } from '../parts/controls';
import { areKeysOn, turnKeys, useKeys } from '../parts/keys';
import { useProtocols } from '../parts/names';
import { strings } from '../strings';
import type { Language } from '../strings/language';
import { changeLanguage, language, languages } from '../strings/language';
import { conditionOf } from './condition';
import { hasResults } from './results';
import { addressOf, path } from './route';
import type { ThemeChoice } from './theme';
import { themeChoice, themeChoices } from './theme';

const words = strings.common;
const pagesOfDaemon = ['floor', 'chair', 'sessions', 'subjects', 'health'] as const;
const pagesOfFleet = ['clinics', 'sessions', 'trends'] as const;
const pagesOf = (link: Link): readonly (keyof typeof words.pages)[] => (link.me.value.isFleet ? pagesOfFleet : pagesOfDaemon);
const livePages = new Set(['floor', 'chair']);
const signs = { good: '●', plain: '○', warning: '▲', error: '✕' } as const;

/** Returns the page whose tab is marked. */
const shownPage = (link: Link): keyof typeof words.pages | undefined => {
  const pages = pagesOf(link);
  const [first = pages[0]] = path.value;
  return pages.find((page) => page === (first === 'compare' ? 'sessions' : first));
};

const Tabs = ({ link }: { link: Link }): JSX.Element => {
  const pages = pagesOf(link);
  const shown = shownPage(link);
  return (
    <nav aria-label={words.navigation} class="tabs">
      {pages.map((page) => (
        <a key={page} href={addressOf(page)} class="tab" aria-current={page === shown ? 'page' : undefined} data-testid={`tab-${page}`}>
          {words.pages[page]}
        </a>
      ))}
    </nav>
  );
};

const StatusLine = ({ link }: { link: Link }): JSX.Element => {
  const { kind, text, hint } = conditionOf(link.state.value, link.since.value, link.status.value, link.dropped.value);
  return (
    <div class={`status-line status-${kind}`} role="status" data-testid="status-line" data-state={link.state.value} title={hint}>
      <span aria-hidden="true">{signs[kind]}</span> {text}
      {hint !== '' && <span class="visually-hidden">. {hint}</span>}
    </div>
  );
};

const ThemeSelect = (): JSX.Element => (
  <select
    aria-label={words.theme.label}
    data-testid="theme"
    value={themeChoice.value}
    onChange={(event) => (themeChoice.value = event.currentTarget.value as ThemeChoice)}
  >
    {themeChoices.map((choice) => (
      <option key={choice} value={choice}>
        {words.theme[choice]}
      </option>
    ))}
  </select>
);

const LanguageSelect = (): JSX.Element => (
  <select
    aria-label={words.language}
    data-testid="language"
    value={language}
    onChange={(event) => changeLanguage(event.currentTarget.value as Language)}
  >
    {Object.entries(languages).map(([choice, name]) => (
      <option key={choice} value={choice} lang={choice}>
        {name}
      </option>
    ))}
  </select>
);

const roleName = (role: Role): string => {
  const names: Readonly<Record<number, string>> = { [Role.VIEWER]: words.role.viewer, [Role.OPERATOR]: words.role.operator, [Role.ENGINEER]: words.role.engineer };
  return names[role] ?? words.role.none;
};

const Who = ({ link }: { link: Link }): JSX.Element => {
  const { user, role, canLogIn } = link.me.value;
  const hasFailed = useSignal(false);
  const isLocal = user === 'local' || user === '';
  const logOut = async (): Promise<void> => {
    hasFailed.value = false;
    await link.logOut().catch(() => (hasFailed.value = true));
  };
  return (
    <div class="who">
      <span data-testid="who">{user === '' ? words.role.none : words.userAndRole(user, roleName(role))}</span>
      {canLogIn && !isLocal && <Button label={words.logOut} onClick={() => void logOut()} testId="log-out" />}
      {hasFailed.value && <Notice kind="error" what={words.logOutFailed} testId="log-out-failed" onDismiss={() => (hasFailed.value = false)} />}
    </div>
  );
};

const KeyList = ({ entries }: { entries: readonly (readonly string[])[] }): JSX.Element => (
  <table>
    <tbody>
      {entries.map(([key, meaning]) => (
        <tr key={key}>
          <th scope="row">{key}</th>
          <td>{meaning}</td>
        </tr>
      ))}
    </tbody>
  </table>
);

const KeyHelp = ({ isFleet, onClose }: { isFleet: boolean; onClose: () => void }): JSX.Element => (
  <div class="key-help">
    <Panel title={words.help.title} testId="key-help" onClose={onClose}>
      <h3>{words.help.everywhere}</h3>
      <KeyList entries={[isFleet ? words.help.fleetPages : words.help.pages, ...words.help.entries]} />
      {!isFleet && <h3>{words.help.live}</h3>}
      {!isFleet && <KeyList entries={words.help.liveEntries} />}
      <label class="row">
        <input type="checkbox" data-testid="keys-on" checked={areKeysOn.value} onChange={(event) => turnKeys(event.currentTarget.checked)} />
        {words.help.on}
      </label>
    </Panel>
  </div>
);

/** `live`: the link of the page that is shown, if it is another one: to the rigs of a clinic. */
export const Shell = ({ link, live, children }: { link: Link; live: Link; children: ComponentChildren }): JSX.Element => {
  const isHelpOpen = useSignal(false);
  useProtocols(live);
  const page = useRef<HTMLElement>(null);
  const isFirst = useRef(true);
  const shown = shownPage(link);
  useEffect(() => {
    page.current?.scrollTo(0, 0); // every page opens at its top
    window.scrollTo(0, 0); // on a phone the window scrolls
    // A link of the page before is gone with its focus: the Tab key and a screen reader continue in the new page.
    if (!isFirst.current && document.activeElement === document.body) page.current?.focus({ preventScroll: true });
    isFirst.current = false;
  }, [path.value]);
  useEffect(() => void (document.title = shown === undefined ? words.documentTitle : words.titleOf(words.pages[shown])), [shown]);
  const { kind, text, hint } = conditionOf(live.state.value, live.since.value, live.status.value, live.dropped.value);
  // A live picture without data says by itself why, and what to do.
  const isInPicture = livePages.has(path.value[link.me.value.isFleet ? 2 : 0] ?? 'floor') && live.state.value !== 'up';
  const isOfResults = hasResults(link, path.value);
  const goTo = (name: string) => () => (location.hash = addressOf(name));
  useKeys({
    '?': () => (isHelpOpen.value = !isHelpOpen.value),
    ...(isHelpOpen.value ? { Escape: () => (isHelpOpen.value = false) } : {}), // otherwise Esc closes the form of the page
    ...Object.fromEntries(pagesOf(link).map((name, index) => [String(index + 1), goTo(name)])),
  });
  return (
    <>
      <header class="shell-head">
        <Tabs link={link} />
        <StatusLine link={live} />
        <LanguageSelect />
        <ThemeSelect />
        <Button label={words.keys} keyName="?" onClick={() => (isHelpOpen.value = !isHelpOpen.value)} testId="show-keys" isPressed={isHelpOpen.value} />
        <Who link={link} />
      </header>
      {kind === 'error' && hint !== '' && !isInPicture && <PassingNotice kind="error" what={text} hint={hint} testId="loud-status" />}
      <main ref={page} tabIndex={-1} class={isOfResults ? 'page page-results' : 'page'} data-testid="page">
        {children}
      </main>
      {isOfResults && (
        <footer class="intended-use" data-testid="intended-use">
          {words.intendedUse}
        </footer>
      )}
      {isHelpOpen.value && <KeyHelp isFleet={link.me.value.isFleet} onClose={() => (isHelpOpen.value = false)} />}
    </>
  );
};
