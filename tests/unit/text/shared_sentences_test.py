# SPDX-License-Identifier: Apache-2.0
import unittest

from shared_sentences import REPORT, STRINGS, faults

FILES = {
    STRINGS + "en/common.ts": "  intendedUse:\n    'For use.',\n",
    STRINGS + "de/common.ts": "  intendedUse: 'Zum Gebrauch.',\n",
    STRINGS + "en/steadiness_decision.ts": "  limit: 'No claim',\n",
    STRINGS + "de/steadiness_decision.ts": "  limit: 'Keine Aussage',\n",
    REPORT + "intended_use.h": 'kIntendedUse =\n    "For "\n    "use.";',
    REPORT + "decision_words.h": 'kDecisionLimit = "No claim.";',
    REPORT + "german.cpp": '{kIntendedUse, "Zum Gebrauch."}, {kDecisionLimit, "Keine Aussage."},',
    "docs/device/intended-use.md": "> For\n> use.\n",
}


class SharedSentences(unittest.TestCase):
    def test_equal_sentences_have_no_fault(self):
        self.assertEqual(faults(FILES.get), [])

    def test_each_place_is_compared(self):
        for name, content in FILES.items():
            changed = {**FILES, name: content.replace("se.", "ser.").replace("auch.", "").replace("claim", "x").replace("Aussage", "y")}
            self.assertNotEqual(faults(changed.get), [], name)


if __name__ == "__main__":
    unittest.main()
