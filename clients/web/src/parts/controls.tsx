// SPDX-License-Identifier: Apache-2.0
// Buttons, tiles, panels and messages of all pages.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';
import { useId } from 'preact/hooks';

import { Role } from '../generated/dts/v1/options_pb';
import type { Answer, Command, Link } from '../link/types';
import { CommandError } from '../link/types';
import { strings } from '../strings';

export interface ButtonProps {
  label: string;
  onClick: () => void;
  testId: string;
  /** Not empty: the button is disabled, and this says why, in sight. */
  whyNot?: string | undefined;
  /** The same reason stands once beside a group of buttons: here it is only told to those who cannot see it. */
  isReasonNearby?: boolean;
  /** Key that does the same: "A". */
  keyName?: string | undefined;
  kind?: 'main' | 'plain' | 'danger';
  isPressed?: boolean | undefined;
}

/**
 * A disabled button keeps its place in the Tab order: who cannot see it hears why. One that was clicked lets go of the focus: Space, pressed next
 * to set a marker, would press it again, and redo a trial. Pressed by a key (detail 0) it keeps the focus.
 */
export const Button = ({ label, onClick, testId, whyNot = '', isReasonNearby = false, keyName, kind = 'plain', isPressed }: ButtonProps): JSX.Element => {
  const reasonId = useId();
  return (
    <span class="button-place">
      <button
        type="button"
        class={`button button-${kind}`}
        data-testid={testId}
        aria-disabled={whyNot !== ''}
        aria-describedby={whyNot !== '' ? reasonId : undefined}
        aria-keyshortcuts={keyName}
        aria-pressed={isPressed}
        onClick={(event) => {
          if (event.detail > 0) event.currentTarget.blur();
          if (whyNot === '') onClick();
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
  /** Running or provisional: grey, and in words. */
  note?: string | undefined;
  isLarge?: boolean;
  children?: ComponentChildren; // a thin spark-line
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

/** Something to be read, near what it is about; never in the way. */
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

/** A notice that stands until it is dismissed or says something else. */
export const PassingNotice = (props: Omit<NoticeProps, 'onDismiss'>): JSX.Element | null => {
  const dismissed = useSignal<string | undefined>(undefined);
  const said = `${props.what} ${props.hint ?? ''}`;
  return dismissed.value === said ? null : <Notice {...props} onDismiss={() => (dismissed.value = said)} />;
};

/** A part of the page with a heading, that can be closed; not modal. */
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

/** A labelled input; `children` is the input and gets the id. */
export const Field = (props: { label: string; hint?: string; children: (id: string) => JSX.Element }): JSX.Element => {
  const id = useId();
  return (
    <div class="field">
      <label for={id}>{props.label}</label>
      {props.children(id)}
      {props.hint !== undefined && props.hint !== '' && <span class="field-hint">{props.hint}</span>}
    </div>
  );
};

export interface Commands {
  /** The answer, or nothing: then `error` says why. One at a time: while one is under way, further ones are ignored. */
  run(command: Command): Promise<Answer | undefined>;
  readonly isBusy: ReadonlySignal<boolean>;
  readonly error: ReadonlySignal<CommandError | undefined>;
  dismiss(): void;
}


/** Commands of one place on a page; their error is shown there with <CommandNotice>. */
export const useCommands = (link: Link): Commands => {
  const isBusy = useSignal(false);
  const error = useSignal<CommandError | undefined>(undefined);
  const run = async (command: Command): Promise<Answer | undefined> => {
    if (isBusy.value) return undefined;
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

/** Why a control that runs sessions is disabled; empty: it is not. Reads signals: call it while rendering. */
export const whyNotOperate = (link: Link): string => {
  if (link.state.value !== 'up') return strings.common.command.needsConnection;
  return link.me.value.role < Role.OPERATOR ? strings.common.command.needsOperator : '';
};
