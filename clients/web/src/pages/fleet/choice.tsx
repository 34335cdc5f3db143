// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import { Field } from '../../parts/controls';

interface ChoiceProps {
  label: string;
  value: string;
  /** Value and word. */
  options: readonly (readonly [string, string])[];
  testId: string;
  onChange: (value: string) => void;
}

export const Choice = ({ label, value, options, testId, onChange }: ChoiceProps): JSX.Element => (
  <Field label={label}>
    {(links) => (
      <select {...links} value={value} data-testid={testId} onChange={(event) => onChange(event.currentTarget.value)}>
        {options.map(([one, word]) => (
          <option key={one} value={one}>
            {word}
          </option>
        ))}
      </select>
    )}
  </Field>
);
