// SPDX-License-Identifier: Apache-2.0

/** Texts by keys of the daemon. Both languages need the same keys; any other key has no text. */
export const byKey = <T extends Readonly<Record<string | number, string>>>(
  texts: T,
): { readonly [K in keyof T]: string } & Readonly<Record<string | number, string>> => texts;
