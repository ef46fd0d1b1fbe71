#!/usr/bin/env python3
"""Lists the tests of a GoogleTest program for ctest, after the program is built (rigwire_test).

  list_tests.py PROGRAM OUTPUT [--each] [NAME=VALUE[,VALUE...]...]

NAME=VALUE are properties of every test, where a comma separates several values. ctest gets one test for each suite, so that a quick suite is
one process; with --each, or where the environment has RIGWIRE_EACH_TEST, one for each test: `./check
FILTER` names tests.
"""
import subprocess
import sys


def entry(program, name, pattern, properties):
    return (f'add_test([==[{name}]==] [==[{program}]==] [==[--gtest_filter={pattern}]==])\n'
            f'set_tests_properties([==[{name}]==] PROPERTIES {properties})\n')


def main():
    program, output, *rest = sys.argv[1:]
    pairs = [word.replace(',', ';').split('=', 1) for word in rest if word != '--each']
    properties = ' '.join(f'[==[{word}]==]' for pair in pairs for word in pair)
    skips = ' SKIP_REGULAR_EXPRESSION [==[\\[  SKIPPED \\]]==]'
    listing = subprocess.run([program, '--gtest_list_tests'], check=True, capture_output=True,
                             text=True).stdout
    suites, each, suite = {}, [], ''
    for line in listing.splitlines():
        name = line.split('#')[0].rstrip()  # behind it stands the value or the type
        if not line.startswith(' '):
            suite = name if name.endswith('.') else ''
            continue
        test = name.strip()
        if not suite or 'DISABLED_' in suite + test:
            continue
        suites.setdefault(suite, entry(program, suite[:-1], suite + '*', properties))
        each.append(entry(program, suite + test, suite + test, properties + skips))
    with open(output, 'w', encoding='utf-8') as file:
        if '--each' in rest:
            file.write(''.join(each))
        else:
            file.write('if(DEFINED ENV{RIGWIRE_EACH_TEST})\n' + ''.join(each) + 'else()\n' +
                       ''.join(suites.values()) + 'endif()\n')


if __name__ == '__main__':
    main()
