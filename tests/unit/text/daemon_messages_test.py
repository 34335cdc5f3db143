# SPDX-License-Identifier: Apache-2.0
import unittest

import daemon_messages


class MessagesOfASource(unittest.TestCase):
    def test_joined_literals_are_one_message_with_places(self):
        source = """return core::fail(ErrorCode::NotFound, "no rig '" + name + "' of " + std::to_string(count) +
                      " rigs", "see the " + hint("x, y"));"""
        self.assertEqual(daemon_messages.messages_of(source), {"no rig '{}' of {} rigs", "see the {}"})

    def test_both_sides_of_a_condition_are_messages(self):
        self.assertEqual(daemon_messages.messages_of('wrong(is_known ? "it is here" : "it is gone")'), {"it is here", "it is gone"})

    def test_a_message_needs_no_call_of_fail(self):
        source = """// "in a comment"
          constexpr std::string_view kAdvice = "plug it in";
          view.problem = folder + " has " + (left ? "no room" : "some room") + " left";
          case Reason::Lost: return "it is lost";
          std::snprintf(text, size, "off by %.2f %%, %zu times", a, b);"""
        expected = {"plug it in", "{} has {} left", "no room", "some room", "it is lost", "off by {} %, {} times"}
        self.assertEqual(daemon_messages.messages_of(source), expected)

    def test_what_a_log_or_a_database_gets_is_no_message(self):
        self.assertEqual(daemon_messages.messages_of('log_.warning("it is late: " + name(1)); query("SELECT a FROM b WHERE c"); use("word")'), set())


class German(unittest.TestCase):
    def setUp(self):
        self.known = daemon_messages.catalogue(
            "  ['rig {!} is gone', 'weg: {}'],\n  [\n    \"it's here\",\n    'hier',\n  ],\n  ['{}: {}', '{}: {}'],\n  ['in the hall', 'in der Halle'],\n")
        self.german = daemon_messages.Translation(self.known)

    def test_the_catalogue_is_read(self):
        self.assertEqual(self.known, {"rig {!} is gone", "it's here", "{}: {}", "in the hall"})

    def test_a_message_without_german_is_found(self):
        # requirement: UI-12
        self.assertTrue(self.german.has_german("rig {} is gone"))
        self.assertFalse(self.german.has_german("rig {} is lost"))

    def test_a_message_of_several_ones_needs_german_for_each(self):
        self.assertTrue(self.german.has_german("in the hall: rig {} is gone"))
        self.assertFalse(self.german.has_german("in the cellar: rig {} is gone"))
        self.assertEqual(self.german.left("in the cellar: rig {} is gone"), ["in the cellar"])

    def test_a_name_is_no_text(self):
        self.assertEqual(self.german.left("rig in the cellar is gone"), [])

    def test_a_part_of_a_sentence_must_occur_in_one_that_has_german(self):
        self.assertTrue(self.german.has_german(" is gone"))
        self.assertFalse(self.german.has_german(" is lost"))


if __name__ == "__main__":
    unittest.main()
