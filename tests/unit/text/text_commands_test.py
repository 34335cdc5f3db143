#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shows with made-up help texts that wrong commands in documents are found, and nothing else."""

import pathlib
import unittest

import text_commands

HELPS = {
    ("dtsctl",): "Commands:\n  session  Sessions\n  key      Keys\n\nOptions:\n  --json  JSON\n",
    ("dtsctl", "session"): "Commands:\n  start  Start\n  trial  Trial\n\nOptions:\n  -h,--help  Help\n",
    ("dtsctl", "session", "start"): "Options:\n  --rig RIG  Rig\n  --field KEY=VALUE  Field\n",
    ("dtsctl", "session", "trial"): "Arguments:\n  ACTION  next, redo or reject\n",
    ("dtsctl", "key"): "Commands:\n  new   New\n  list  List\n",
    ("dtslab",): "Commands:\n  sway  Sway\n",
}


class MadeUpHelps:
    def text(self, *words):
        return HELPS.get(words, "")


def faults(text):
    return list(text_commands.faults_of_document(pathlib.Path("a.md"), text, MadeUpHelps()))


class CommandsTest(unittest.TestCase):
    def test_commands_that_exist_pass(self):
        for command in ("dtsctl session start --rig floor --field a=b", "dtsctl session trial next", "dtsctl key new|list", "dtsctl --json",
                        "build/release/bin/dtsctl session start --rig floor | head --lines 3", "dtsctl session COMMAND", "dtslab -h",
                        "id=$(dtsctl session start --rig floor)", "dtsctl session start --rig floor > file --wrong"):
            self.assertEqual(faults(f"`{command}`\n\n    $ {command}    # a remark --wrong\n"), [], command)

    def test_wrong_commands_and_options_are_found_in_spans_and_blocks(self):
        for command in ("dtsctl sesion", "dtsctl session go", "dtsctl session start --rug floor", "dtsctl key new|lost", "dtslab --json",
                        "dtsctl --json session go"):
            findings = faults(f"see `{command}`\n\n    $ {command}\n\n```\n{command}\n```\n")
            self.assertEqual(len(findings), 3, command)
            self.assertTrue(findings[0].startswith("a.md:1: "), findings)
            self.assertTrue(findings[1].startswith("a.md:3: "), findings)

    def test_continued_line_is_one_command(self):
        self.assertEqual(faults("    $ dtsctl session start \\\n        --rig floor\n"), [])
        (finding,) = faults("    $ dtsctl session start --rig floor \\\n        --wrong\n")
        self.assertEqual(finding, "a.md:2: dtsctl session start has no option --wrong")

    def test_span_with_a_line_break_is_one_command(self):
        (finding,) = faults("run `dtsctl session\nstart --wrong`\n")
        self.assertEqual(finding, "a.md:1: dtsctl session start has no option --wrong")

    def test_prose_and_pictures_are_not_commands(self):
        self.assertEqual(faults("dtsctl goes there --wrong\n\n    dtsctl    session, keys --> dtslab   whatever --> x\n"), [])


if __name__ == "__main__":
    unittest.main()
