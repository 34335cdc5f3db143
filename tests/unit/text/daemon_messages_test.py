# SPDX-License-Identifier: Apache-2.0
import unittest

import daemon_messages


class MessagesOfASource(unittest.TestCase):
    def test_joined_literals_are_one_message_with_places(self):
        source = """return core::fail(ErrorCode::NotFound, "no rig '" + name + "' of " + std::to_string(count) +
                      " rigs", "see " + hint("x, y"));"""
        self.assertEqual(daemon_messages.messages_of(source), {"no rig '{}' of {} rigs", "see {}"})

    def test_both_sides_of_a_condition_are_messages(self):
        self.assertEqual(daemon_messages.messages_of('wrong(is_known ? "it is here" : "it is gone")'), {"it is here", "it is gone"})

    def test_a_message_without_german_is_found(self):
        # requirement: UI-12
        known = daemon_messages.catalogue("  ['rig {} is gone', 'weg: {}'],\n  [\n    \"it's here\",\n    'hier',\n  ],\n")
        self.assertEqual(known, {"rig {} is gone", "it's here"})
        self.assertTrue(daemon_messages.has_german("rig {} is gone", known))
        self.assertFalse(daemon_messages.has_german("rig {} is lost", known))


if __name__ == "__main__":
    unittest.main()
