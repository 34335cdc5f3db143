# SPDX-License-Identifier: Apache-2.0
import unittest

import log_lines

DOCUMENT = """## Before
- `not looked at`: in another section.

## What log lines mean

- `rig 'R': N scans missing
  before segment S`, `it is late: ...`: run `dtsctl status`. With "no such rig", look again.
  - `... fell silent`: check the cable.

## After
- `not looked at`: in another section.
"""
SOURCE = """// "fell silent"
log_.warning("rig '" + name + "': " + count + " scans missing before "
                                              "segment " + segment);
log_.error("it is late: " + name);
fail("there is no such rig \\"floor\\"");
"""


class LogLines(unittest.TestCase):
    def test_a_message_that_no_program_prints_is_found(self):
        found = log_lines.faults(DOCUMENT, log_lines.strings(SOURCE))
        self.assertEqual(found, ["docs/operating.md: no program prints: ... fell silent (searched: fell silent)"])

    def test_each_piece_of_several_words_must_be_printed(self):
        printed = log_lines.strings(SOURCE.replace("missing", "lost").replace("no such rig", "no rig"))
        self.assertEqual([line.partition("(searched: ")[2] for line in log_lines.faults(DOCUMENT, printed)],
                         ["scans missing before segment)", "no such rig)", "fell silent)"])

    def test_commands_are_no_messages(self):
        self.assertEqual(log_lines.messages("`it is late`: run `dtsctl status`"), ["it is late"])

    def test_pieces_of_one_word_count_only_alone(self):
        self.assertEqual(log_lines.pieces("rig 'R': device STATE: ..."), ["device"])
        self.assertEqual(log_lines.pieces("D has room for only N of recording"), ["has room for only", "of recording"])


if __name__ == "__main__":
    unittest.main()
