// SPDX-License-Identifier: Apache-2.0
// Buttons, tiles, panels and notices of all pages.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';
import { useId, useRef } from 'preact/hooks';

import { Role } from '../generated/dts/v1/options_pb';
import type { Answer, Command, Link } from '../link/types';
import { CommandError } from '../link/types';
import { strings } from '../strings';

export interface ButtonProps {
  label: string;
  onClick: () => void;
  testId: string;
  /** If not empty, the button is disabled and shows this reason. */
  whyNot?: string | undefined;
  /** The page shows the reason once beside a group of buttons; here only screen readers get it. */
  isReasonNearby?: boolean;
  /** The key that does the same: "A". */
  keyName?: string | undefined;
  kind?: 'main' | 'plain' | 'danger';
  isPressed?: boolean | undefined;
  /** The second click of a double click counts, too. */
  mayRepeat?: boolean;
}

const doubleClickMs = 1000; // longer than any browser waits for the second click

/**
 * A disabled button stays in the Tab order, so that a screen reader can read the reason. A clicked button gives up the focus: otherwise Space,
 * meant to set a marker, would press it again and redo a trial. A button pressed by a key (detail 0) keeps the focus. The second click of a
 * double click and a held Enter do nothing: the button may mean something else by then ("Stop now"), and a second redo cannot be undone.
 */
export const Button = (props: ButtonProps): JSX.Element => {
  const { label, onClick, testId, whyNot = '', isReasonNearby = false, keyName, kind = 'plain', isPressed, mayRepeat = false } = props;
  const reasonId = useId();
  const clickedMs = useRef(-Infinity);
  return (
    <span class="button-place">
      <button
        type="button"
        class={`button button-${kind}`}
        data-testid={testId}
        aria-disabled={whyNot !== ''}
        aria-describedby={whyNot !== '' ? reasonId : undefined}
        aria-keyshortcuts={keyName === undefined || keyName.length === 1 ? keyName : 'Space'} // the attribute has English names
        aria-pressed={isPressed}
        onKeyDown={(event) => {
          if (event.repeat && event.key === 'Enter') event.preventDefault();
        }}
        onClick={(event) => {
          if (event.detail > 0) event.currentTarget.blur();
          // The browser counts clicks by place and time: the first one of this button may be the second one there.
          const isSecond = event.detail > 1 && event.timeStamp - clickedMs.current < doubleClickMs;
          clickedMs.current = event.timeStamp;
          if (whyNot === '' && (!isSecond || mayRepeat)) onClick();
        }}
      >
        {label}
        {keyName !== undefined && <kbd aria-hidden="true">{keyName}</kbd>}
      </button>
      {whyNot !== '' && (
        <span class={isReasonNearby ? 'visually-hidden' : 'why-not'} id={reasonId}>
          {whyNot}
        </span>
      )}
    </span>
  );
};

export interface TileProps {
  label: string;
  value: string;
  unit?: string;
  testId: string;
  /** "preliminary" and the like; the value is then grey. */
  note?: string | undefined;
  isLarge?: boolean;
  children?: ComponentChildren; // a spark line
}

export const Tile = ({ label, value, unit = '', testId, note, isLarge = false, children }: TileProps): JSX.Element => (
  <div class={`tile${isLarge ? ' tile-large' : ''}${note !== undefined ? ' tile-noted' : ''}`}>
    <div class="tile-label">{label}</div>
    <div class="tile-value">
      <span data-testid={testId}>{value}</span> <span class="unit">{unit}</span>
    </div>
    {note !== undefined && <div class="tile-note">{note}</div>}
    {children}
  </div>
);

export interface NoticeProps {
  kind: 'error' | 'warning' | 'good' | 'plain';
  what: string;
  hint?: string;
  testId: string;
  onDismiss?: () => void;
}

const signs = { error: '✕', warning: '!', good: '✓', plain: 'i' } as const;

/** A message beside the thing it is about. It never covers other content by itself. */
export const Notice = ({ kind, what, hint = '', testId, onDismiss }: NoticeProps): JSX.Element => (
  <div class={`notice notice-${kind}`} role={kind === 'error' ? 'alert' : 'status'} data-testid={testId}>
    <span class="notice-sign" aria-hidden="true">
      {signs[kind]}
    </span>
    <div>
      <div class="notice-what">{what}</div>
      {hint !== '' && <div class="notice-hint">{hint}</div>}
    </div>
    {onDismiss !== undefined && <Button label={strings.common.dismiss} onClick={onDismiss} testId={`${testId}-dismiss`} />}
  </div>
);

/** A notice that stays until it is dismissed; a new text shows it again. */
export const PassingNotice = (props: Omit<NoticeProps, 'onDismiss'>): JSX.Element | null => {
  const dismissed = useSignal<string | undefined>(undefined);
  const text = `${props.what} ${props.hint ?? ''}`;
  return dismissed.value === text ? null : <Notice {...props} onDismiss={() => (dismissed.value = text)} />;
};

/** A part of the page with a heading; can have a Close button. Not modal. */
export const Panel = (props: { title: string; testId: string; onClose?: () => void; children: ComponentChildren }): JSX.Element => {
  const headingId = useId();
  return (
    <section class="panel" aria-labelledby={headingId} data-testid={props.testId}>
      <header class="panel-head">
        <h2 id={headingId}>{props.title}</h2>
        {props.onClose !== undefined && <Button label={strings.common.close} onClick={props.onClose} testId={`${props.testId}-close`} />}
      </header>
      {props.children}
    </section>
  );
};

/** Attributes that tie an input to its label, hint and error. */
export interface FieldLinks {
  readonly id: string;
  readonly 'aria-describedby': string | undefined;
  readonly 'aria-invalid': boolean | undefined;
}

/** A labelled input; `children` returns the input with the given attributes. An error takes the place of the hint. */
export const Field = (props: { label: string; hint?: string; error?: string | undefined; children: (links: FieldLinks) => JSX.Element }): JSX.Element => {
  const id = useId();
  const { label, hint = '', error = '' } = props;
  const noteId = `${id}-note`;
  const note = error === '' ? hint : error;
  return (
    <div class={`field${error === '' ? '' : ' field-wrong'}`}>
      <label for={id}>{label}</label>
      {props.children({ id, 'aria-describedby': note === '' ? undefined : noteId, 'aria-invalid': error === '' ? undefined : true })}
      {note !== '' && (
        <span id={noteId} class={error === '' ? 'field-hint' : 'field-error'} role={error === '' ? undefined : 'alert'}>
          {note}
        </span>
      )}
    </div>
  );
};

export interface Commands {
  /** Returns the answer, or nothing if it failed: see `error`. Ignores further commands while one is pending, unless they can overlap. */
  run(command: Command): Promise<Answer | undefined>;
  readonly isBusy: ReadonlySignal<boolean>;
  readonly error: ReadonlySignal<CommandError | undefined>;
  dismiss(): void;
}

/** Commands of one place on a page; <CommandNotice> shows their error there. `canOverlap`: a command does not wait for the answer to the one before. */
export const useCommands = (link: Link, canOverlap = false): Commands => {
  const isBusy = useSignal(false);
  const error = useSignal<CommandError | undefined>(undefined);
  const run = async (command: Command): Promise<Answer | undefined> => {
    if (isBusy.value && !canOverlap) return undefined;
    isBusy.value = true;
    error.value = undefined;
    try {
      return await link.send(command);
    } catch (problem) {
      error.value = problem instanceof CommandError ? problem : new CommandError(0, String(problem), '');
      return undefined;
    } finally {
      isBusy.value = false;
    }
  };
  return { run, isBusy, error, dismiss: () => (error.value = undefined) };
};

export const CommandNotice = ({ commands, testId }: { commands: Commands; testId: string }): JSX.Element | null =>
  commands.error.value === undefined ? null : (
    <Notice kind="error" what={commands.error.value.message} hint={commands.error.value.hint} testId={testId} onDismiss={commands.dismiss} />
  );

/** Returns why a control that runs sessions is disabled, or "" if it is enabled. Reads signals: call it while rendering. */
export const whyNotOperate = (link: Link): string => {
  if (link.state.value !== 'up') return strings.common.command.needsConnection;
  return link.me.value.role < Role.OPERATOR ? strings.common.command.needsOperator : '';
};
