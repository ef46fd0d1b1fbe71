// "Did you mean": the known names that are nearest to a word, as hil/configuration/suggest.h finds them.

// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`.
export function editDistance(a, b) {
  let before = [];
  let previous = Array.from({ length: b.length + 1 }, (_, j) => j);
  for (let i = 1; i <= a.length; ++i) {
    const current = [i];
    for (let j = 1; j <= b.length; ++j) {
      const cost = a[i - 1] === b[j - 1] ? 0 : 1;
      current[j] = Math.min(previous[j] + 1, current[j - 1] + 1, previous[j - 1] + cost);
      if (i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1]) {
        current[j] = Math.min(current[j], before[j - 2] + 1);
      }
    }
    before = previous;
    previous = current;
  }
  return previous[b.length];
}

// How far `word` is from `known`; null: too far to be meant. What holds the word is as near as a slip.
function distance(word, known) {
  const limit = Math.max(1, Math.floor((Math.max(word.length, known.length) + 1) / 3));
  const edits = editDistance(word, known);
  const holds = word.length >= 3 && known.includes(word);
  return edits <= limit || holds ? Math.min(edits, limit) : null;
}

// The names nearest to `word`, the nearest first, `max` at most. A name counts without its first part, too:
// "joint_rad.1" of "truth.joint_rad.1".
export function nearestNames(word, names, max = 3) {
  const wanted = word.toLowerCase();
  const found = [];
  for (const name of names) {
    const known = name.toLowerCase();
    const distances = [known, known.slice(known.indexOf(".") + 1)]
      .map((part) => distance(wanted, part))
      .filter((far) => far !== null);
    if (distances.length > 0) found.push([Math.min(...distances), name]);
  }
  return found
    .sort(([a, left], [b, right]) => a - b || left.length - right.length)
    .slice(0, max)
    .map(([, name]) => name);
}
