#!/usr/bin/env python3
"""Prints the dearest tests of a run of ctest, beside what a test of their class should cost: a table
to act on. Seconds are wall time of this machine, so that none of them is a failure.

  scripts/dearest-tests.py BUILD [COUNT]    COUNT: 20

BUILD/check.xml is the result, as ctest --output-junit writes it. A suite of GoogleTest is one process; its tests are read from its output.
"""
import collections
import os
import re
import sys
import xml.etree.ElementTree as xml

# What a test of a class should cost at most, s: the class is its first label.
GOALS = {'conformance': 60, 'examples': 60, 'kernel': 60, 'install': 60, 'structure': 10, 'hil': 10,
         'bench': 10, 'oracle': 10, 'sim': 10}
UNIT = 1

INNER = re.compile(r'^\[ +(?:OK|FAILED|SKIPPED) +\] (\S+?)(?:, where .*)? \((\d+) ms\)$', re.MULTILINE)


# Of the files that ctest reads: a test or its suite, and its first label.
LABEL = re.compile(r'^ *set_tests_properties\((?:\[=*\[)?(.+?)(?:\]=*\])? PROPERTIES '
                   r'.*?LABELS(?:\]==\])? (?:"|\[==\[)([^"\];]+)', re.MULTILINE)


def labels_of(build):
    labels = {}
    for place, _, files in os.walk(os.path.join(build, 'tests')):
        for file in files:
            if file.endswith('.cmake'):
                with open(os.path.join(place, file), encoding='utf-8') as text:
                    labels.update(LABEL.findall(text.read()))
    return labels


def tests_of(build):
    """(class, name, seconds) of each test."""
    labels = labels_of(build)
    for case in xml.parse(os.path.join(build, 'check.xml')).getroot().iter('testcase'):
        label = labels.get(case.get('name'), 'others')
        inner = INNER.findall(case.findtext('system-out') or '')
        if len(inner) > 1:
            yield from ((label, name, int(ms) / 1000.0) for name, ms in inner)
        else:
            yield label, case.get('name'), float(case.get('time', 0.0))


def main():
    if len(sys.argv) not in (2, 3):
        print(__doc__.strip())
        return 2
    tests = sorted(tests_of(sys.argv[1]), key=lambda test: -test[2])
    by_class = collections.Counter()
    for label, _, seconds in tests:
        by_class[label] += seconds
    print(f'{len(tests)} tests; ' + ', '.join(f'{label} {seconds:.0f} s'
                                              for label, seconds in by_class.most_common()))
    print(f'{"seconds":>8} {"goal":>5}  test')
    for label, name, seconds in tests[:int(sys.argv[2]) if len(sys.argv) == 3 else 20]:
        print(f'{seconds:8.1f} {GOALS.get(label, UNIT):5}  {label}: {name}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
