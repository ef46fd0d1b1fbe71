#!/usr/bin/env python3
"""Which test programs a filter of ./check can match, told before they are built.

  scripts/tests-that-match.py BUILD FILTER    a line for each label of which a test can match:
                                              LABEL TARGET...
  scripts/tests-that-match.py BUILD --verify  every test that BUILD knows is found by its name; of
                                              programs older than their sources nothing is known

Names of GoogleTest's tests are read from the sources, where suite and test stand in the macros. The
rest of a made name, of a value or a type, is not known before the program runs. But its words stand
in the file, in quotes or in the list of values or types (--verify holds that), so that a filter with
a word that is not there cannot match. A filter that is more than words, '.', '.*', '^', '$' and '|'
may match every made name. All other tests are known to ctest as soon as BUILD is configured. ctest
itself judges names that are known.
"""
import json
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TESTS = os.path.join(ROOT, 'tests')
# Programs of GoogleTest, FOLDER_tests from tests/FOLDER/, with the folder's name as label.
FOLDERS = ('bench', 'conform', 'conformance', 'drivers', 'emulators', 'examples', 'fields', 'hil',
           'oracle', 'protocols', 'sim')

PLAIN = re.compile(r'^\s*TEST(?:_F)?\s*\(\s*(\w+)\s*,\s*(?:DISABLED_)?(\w+)\s*\)', re.MULTILINE)
MADE = re.compile(r'^\s*(?:TEST_P|TYPED_TEST|TYPED_TEST_P)\s*\(\s*(\w+)\s*,\s*(\w+)\s*\)',
                  re.MULTILINE)
VALUES_OR_TYPES = re.compile(r'(?:INSTANTIATE_\w+|\bTypes\s*<).*?;\n', re.DOTALL)
QUOTED = re.compile(r'"(?:[^"\\\n]|\\.)*"')
OF_TYPES = ' rigwire anonymous namespace '  # what the compiler adds to the name of a type
WORDS_ALONE = re.compile(r'^(?:[\w/<>: ,#-]|\\\W|\.\*?)*$')


def text_of(path, seen):
    """A source of tests/ and, behind it, those headers of tests/ that it includes."""
    if path in seen:
        return ''
    seen.add(path)
    with open(path, encoding='utf-8') as file:
        text = file.read()
    for name in re.findall(r'^#include "([^"]+)"', text, re.MULTILINE):
        for place in (ROOT, os.path.dirname(path), os.path.join(TESTS, 'support')):
            header = os.path.normpath(os.path.join(place, name))
            if header.startswith(TESTS + os.sep) and os.path.exists(header):
                text += text_of(header, seen)
    return text


def names_of(folder):
    """Plain names of the folder's tests, and of each file with made names the text with their
    words."""
    plain, made = set(), []
    for place, _, files in os.walk(os.path.join(TESTS, folder)):
        for name in files:
            if not name.endswith('.cpp'):
                continue
            text = text_of(os.path.join(place, name), set())
            plain.update('.'.join(pair) for pair in PLAIN.findall(text))
            pairs = MADE.findall(text)
            if pairs:
                made.append(' '.join([*map(' '.join, pairs), *QUOTED.findall(text),
                                      *VALUES_OR_TYPES.findall(text), OF_TYPES]))
    return plain, made


def pieces(text):
    """Runs of letters within which no name is put together: a capital begins a new one."""
    return re.findall(r'[A-Z]?[a-z]+|[A-Z]', text)


def made_can_match(pattern, made):
    if not made:
        return False
    for part in pattern.split('|'):
        part = re.sub(r'^\^|\$$', '', part)
        if not WORDS_ALONE.match(part):
            return True
        words = pieces(re.sub(r'\\\W|\.\*?', ' ', part))
        if any(all(word in text for word in words) for text in made):
            return True
    return False


def known_tests(build, pattern=None):
    """(name, labels, command) of what ctest knows of a folder; no command: not built."""
    arguments = ['ctest', '--test-dir', build, '--show-only=json-v1']
    if pattern is not None:
        arguments += ['-R', pattern]
    each = {**os.environ, 'RIGWIRE_EACH_TEST': '1'}  # tests/support/list_tests.py
    shown = subprocess.run(arguments, check=True, capture_output=True, text=True, env=each)
    if 'RegularExpression::compile' in shown.stderr:
        sys.exit(f'check: no regular expression: {pattern}\n{shown.stderr.strip()}')
    for test in json.loads(shown.stdout)['tests']:
        labels = [p['value'] for p in test.get('properties', []) if p['name'] == 'LABELS']
        yield test['name'], labels[0] if labels else [], test.get('command', [])


def folders_with(names, pattern):
    """Of {folder: names} the folders with a name that ctest -R takes."""
    with tempfile.TemporaryDirectory() as build:
        with open(os.path.join(build, 'CTestTestfile.cmake'), 'w', encoding='utf-8') as top:
            for folder in names:
                os.mkdir(os.path.join(build, folder))
                top.write(f'subdirs({folder})\n')
        for folder, of_folder in names.items():
            with open(os.path.join(build, folder, 'CTestTestfile.cmake'), 'w',
                      encoding='utf-8') as file:
                for name in of_folder:
                    file.write(f'add_test({name} true)\n'
                               f'set_tests_properties({name} PROPERTIES LABELS {folder})\n')
        return {labels[0] for _, labels, _ in known_tests(build, pattern)}


def targets_of(label, name):
    """What is built for a test that is none of GoogleTest's."""
    if label == 'structure':
        return []
    if label == 'fuzz-corpus':
        return ['corpus_tests']
    if name == 'benchmarks_run':
        return ['rigwire_benchmarks']
    return ['all']


def matching(build, pattern):
    found = {}
    names = {folder: names_of(folder) for folder in FOLDERS}
    for folder in folders_with({folder: plain for folder, (plain, _) in names.items()}, pattern):
        found[folder] = [folder + '_tests']
    for folder, (_, made) in names.items():
        if made_can_match(pattern, made):
            found[folder] = [folder + '_tests']
    for name, labels, _ in known_tests(build, pattern):
        for label in labels:
            if label not in (*FOLDERS, 'quick'):
                of_label = found.setdefault(label, [])
                of_label += [t for t in targets_of(label, name) if t not in of_label]
    return found


def newest(folder):
    return max(os.path.getmtime(os.path.join(place, file))
               for place, _, files in os.walk(os.path.join(TESTS, folder)) for file in files)


def verify(build):
    """Exit code 1 and the names when a filter could miss a test."""
    names = {folder: names_of(folder) for folder in FOLDERS}
    missed, seen = [], 0
    for name, labels, command in known_tests(build):
        if not labels and not name.endswith('_NOT_BUILT'):
            missed.append(f'no label: {name}')
        for folder in set(labels) & set(FOLDERS):
            if not command or os.path.getmtime(command[0]) < newest(folder):
                continue
            seen += 1
            plain, made = names[folder]
            if name not in plain and not any(all(word in text for word in pieces(name))
                                             for text in made):
                missed.append(f'{folder}: {name}')
    for line in missed:
        print(line)
    print(f'{len(missed)} of {seen} names cannot be told from the sources')
    return 1 if missed else 0


def main():
    if len(sys.argv) != 3:
        print(__doc__.strip())
        return 2
    build, pattern = sys.argv[1:]
    if pattern == '--verify':
        return verify(build)
    for label, targets in sorted(matching(build, pattern).items()):
        print(' '.join([label, *targets]))
    return 0


if __name__ == '__main__':
    sys.exit(main())
