#!/usr/bin/env python3
"""Prints the twenty dearest tests of the last run of ctest, beside what a test of their class should
cost: a table to act on. Seconds are wall time of this machine, so that none of them is a failure.

  scripts/dearest-tests.py BUILD [COUNT]

A suite of GoogleTest is one process; its tests are read from its output.
"""
import collections
import os
import re
import sys

# What a test of a class should cost at most, s: the class is its label.
GOALS = {'conformance': 60, 'examples': 60, 'kernel': 60, 'install': 60, 'structure': 10, 'hil': 10,
         'bench': 10, 'oracle': 10, 'sim': 10}
UNIT = 1

NAME = re.compile(r'^\d+/\d+ Test: (.+)$')
SECONDS = re.compile(r'^Test time = +([\d.]+) sec')
PASSED = re.compile(r'^\[ +(?:OK|FAILED|SKIPPED) +\] (\S+)(?:, where .*)? \((\d+) ms\)$')


def tests_of(path):
    """(name, seconds, seconds of the process) of each test, and the sum over all processes."""
    found, total, process, inner = [], 0.0, '', []
    with open(path, encoding='utf-8', errors='replace') as log:
        for line in log:
            line = line.rstrip('\n')
            if match := NAME.match(line):
                process, inner = match.group(1), []
            elif match := PASSED.match(line):
                inner.append((match.group(1), int(match.group(2)) / 1000.0))
            elif match := SECONDS.match(line):
                seconds = float(match.group(1))
                total += seconds
                found += inner if len(inner) > 1 else [(process, seconds)]
    return found, total


def labels_of(build):
    """{name of a test or of its suite: label}, from the files that ctest reads."""
    labels = {}
    pattern = re.compile(r'^ *set_tests_properties\((?:\[=*\[)?(.+?)(?:\]=*\])? PROPERTIES '
                         r'.*?LABELS(?:\]==\])? (?:"|\[==\[)([^"\];]+)', re.MULTILINE)
    for place, _, files in os.walk(os.path.join(build, 'tests')):
        for file in files:
            if file.endswith('.cmake'):
                with open(os.path.join(place, file), encoding='utf-8') as text:
                    labels.update(pattern.findall(text.read()))
    return labels


def main():
    if len(sys.argv) not in (2, 3):
        print(__doc__.strip())
        return 2
    build = sys.argv[1]
    count = int(sys.argv[2]) if len(sys.argv) == 3 else 20
    log = os.path.join(build, 'Testing', 'Temporary', 'LastTest.log')
    found, total = tests_of(log)
    labels = labels_of(build)
    by_label = collections.Counter()
    for name, seconds in found:
        by_label[labels.get(name) or labels.get(name.rsplit('.', 1)[0], '')] += seconds
    print(f'{len(found)} tests, {total:.0f} s of processes; by class: ' +
          ', '.join(f'{label or "others"} {seconds:.0f} s'
                    for label, seconds in by_label.most_common()))
    print(f'{"seconds":>8} {"goal":>5}  test')
    for name, seconds in sorted(found, key=lambda test: -test[1])[:count]:
        label = labels.get(name) or labels.get(name.rsplit('.', 1)[0], '')
        print(f'{seconds:8.1f} {GOALS.get(label, UNIT):5}  {label}: {name}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
