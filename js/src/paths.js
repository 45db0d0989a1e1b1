// Maps paths of Windows to the file system of the program, which has a single root. Drives become folders in this root.

const ROOT = /^[A-Za-z]:(?=\\|\/|$)/;

/**
 * Converts a path of Windows for the program. `word` is the path, or a word of the command line that is a path or has a
 * path after `=`. C:\models\face.glb becomes /C:/models/face.glb, and \models\face.glb gets the drive of the folder
 * cwd.
 */
export function fromWindows(word, cwd) {
  const [option] = word.match(/^--[a-z-]+=/) ?? [''];
  const path = word.slice(option.length).replaceAll('\\', '/');
  const drive = (of) => of.match(ROOT)?.[0].toUpperCase();
  if (drive(path)) return `${option}/${drive(path)}${path.slice(2)}`;
  if (/^\/(?!\/)/.test(path) && path !== '/dev/stdin' && drive(cwd)) return `${option}/${drive(cwd)}${path}`;
  return option + path;
}
