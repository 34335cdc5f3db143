#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shows on small made-up trees that the checks find what they must find, and nothing else."""

import contextlib
import io
import pathlib
import tempfile
import unittest

import text_rules


class TreeTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


class LinesTest(TreeTest):
    def test_lines_below_120_characters_pass(self):
        self.write("a.md", "x" * 119 + "\n")
        self.write("a.txt", "x" * 500 + "\n")
        self.assertEqual(text_rules.long_lines(self.root), [])

    def test_longer_line_is_found_also_in_code_but_not_in_tables(self):
        self.write("docs/a.md", "| " + "x" * 120 + " |\n")
        self.assertEqual(text_rules.long_lines(self.root), [])
        for line in ("x" * 120, "    " + "x" * 120):
            self.write("docs/a.md", f"short\n{line}\n")
            findings = text_rules.long_lines(self.root)
            self.assertEqual(len(findings), 1, line)
            self.assertTrue(findings[0].startswith("docs/a.md:2: "), findings)

    def test_marks_of_an_unfinished_merge_are_found(self):
        self.write("a.md", "<<<<<<< HEAD\none\n=======\ntwo\n>>>>>>> branch\n")
        self.assertEqual([finding.split(":")[1] for finding in text_rules.long_lines(self.root)], ["1", "3", "5"])

    def test_generated_folders_are_not_read(self):
        self.write("build/a.md", "x" * 120)
        self.write("clients/web/node_modules/p/a.md", "x" * 120)
        self.assertEqual(text_rules.long_lines(self.root), [])


class LinksTest(TreeTest):
    def faults(self, text):
        self.write("docs/a.md", text)
        self.write("docs/b.md", "# One: two `three`\n\n## Again\n\n## Again\n\n    # no heading\n")
        self.write("picture.png", "")
        return text_rules.dead_links(self.root)

    def test_links_to_files_and_headings_pass(self):
        links = "[b](b.md) [c](b.md#one-two-three) [d](b.md#again-1) ![e](../picture.png) [f](#here) [g](https://example.org/x)"
        self.assertEqual(self.faults(f"# Here\n{links}\n"), [])

    def test_dead_links_are_found(self):
        for target in ("c.md", "../b.md", "b.md#two", "b.md#no-heading", "b.md#again-2", "#there", "../picture.png#x", "../../x"):
            findings = self.faults(f"# Here\n\n[b]({target})\n")
            self.assertEqual(len(findings), 1, target)
            self.assertTrue(findings[0].startswith("docs/a.md:3: "), findings)

    def test_link_whose_text_has_a_line_break_is_found(self):
        self.assertEqual(len(self.faults("see [some\ntext](gone.md)\n")), 1)

    def test_code_has_no_links(self):
        self.assertEqual(self.faults("`[b](c.md)`\n\n    [b](c.md)\n\n```\n[b](c.md)\n```\n"), [])


class WordsTest(TreeTest):
    def words(self, path, text):
        self.write(path, text)
        findings = text_rules.banned_words(self.root)
        (self.root / path).unlink()
        return findings

    def test_each_pattern_is_found_in_a_document(self):
        for text in ("a pseudonym", "test persons", "Whoever", "somebody who", "a hole", "mended", "anew", "tells", "was told", "heard", "went on",
                     "goes on", "refusal", "broken off", "feign", "drop-out", "stands in the file", "do without", "is given up", "zeroing"):
            self.assertEqual(len(self.words("a.md", f"one\n\nIt is {text} here.\n")), 1, text)

    def test_similar_words_pass(self):
        for text in ("amendment", "intelligible", "stands on the plate", "retold", "goes on the plate", "recommend"):
            self.assertEqual(self.words("a.md", text), [], text)

    def test_finding_names_line_and_replacement(self):
        (finding,) = self.words("docs/a.md", "one\n\ntwo and\nthree anew\n")
        self.assertEqual(finding, "docs/a.md:4: 'anew': write again")

    def test_words_across_a_line_break_are_found_at_their_first_line(self):
        (finding,) = self.words("a.md", "and so it\ngoes\non\n")
        self.assertTrue(finding.startswith("a.md:2: 'goes on'"), finding)

    def test_code_quotations_and_targets_of_links_pass(self):
        text = 'a `tells` b "anew" [c](pseudonym.md)\n\n    anew\n\n- list\n\n       anew\n'
        self.assertEqual(self.words("a.md", text), [])
        self.assertEqual(len(self.words("a.md", "- list\n    anew\n")), 1)  # continues the item

    def test_comments_are_read_and_code_is_not(self):
        self.assertEqual(len(self.words("daemon/core/a.cpp", "// it tells\nint anew;\n/* done\n * anew */\n")), 2)
        self.assertEqual(self.words("daemon/core/a.h", 'int tells = 0;  // `tells` and "anew"\n'), [])
        self.assertEqual(len(self.words("clients/python/src/a.py", '"""It tells."""\nx = 1  # anew\ntells = "# anew"\n')), 2)
        self.assertEqual(self.words("clients/python/src/a.py", "tells = (\n"), [])

    def test_messages_are_sentences_in_strings(self):
        self.assertEqual(len(self.words("daemon/core/a.cpp", 'f("made anew", "https://a//anew", R"(it tells\nand hears)");\n')), 3)
        self.assertEqual(self.words("daemon/core/a.cpp", 'f("anew");\n'), [])  # a key, not a sentence
        self.assertEqual(self.words("daemon/core/a.cpp", 'f("SELECT pseudonym FROM subjects");\n'), [])
        self.assertEqual(len(self.words("clients/web/src/strings/a.ts", "x: 'start anew', y: `was told ${z}`\n")), 2)

    def test_listed_files_are_exempt_for_that_kind_only(self):
        self.write("tests/unit/text/not_clean.txt", "# comment\n\ncomments daemon/a.cpp\n")
        (finding,) = self.words("daemon/a.cpp", '// tells\nf("made anew");\n')
        self.assertTrue(finding.startswith("daemon/a.cpp:2: "), finding)

    def test_list_prints_what_is_not_clean(self):
        self.write("a.md", "anew\n")
        self.write("daemon/a.cpp", "// tells\n// again\n")
        self.assertEqual(text_rules.list_of_not_clean(self.root), ["documents a.md", "comments daemon/a.cpp"])

    def test_glossary_may_name_the_words(self):
        self.assertEqual(self.words("docs/glossary.md", "Not: anew.\n"), [])


class MainTest(TreeTest):
    def run_main(self, *arguments):
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(io.StringIO()):
            status = text_rules.main(list(arguments))
        return status, output.getvalue()

    def test_status_is_0_without_and_1_with_findings(self):
        self.write("a.md", "good\n")
        self.assertEqual(self.run_main("words", str(self.root)), (0, ""))
        self.write("a.md", "anew\n")
        self.assertEqual(self.run_main("words", str(self.root)), (1, "a.md:1: 'anew': write again\n"))

    def test_wrong_use_or_a_tree_without_documents_is_2(self):
        for arguments in ((), ("words",), ("nonsense", str(self.root)), ("words", str(self.root))):
            self.assertEqual(self.run_main(*arguments)[0], 2, arguments)


if __name__ == "__main__":
    unittest.main()
