// The colour scale viridis as 16 colours, between which colours are interpolated linearly. Colour-blind people can read
// it, and its lightness increases steadily.

export const VIRIDIS = [
  0x440154, 0x481a6c, 0x472f7d, 0x414487, 0x39568c, 0x31688e, 0x2a788e, 0x23888e,
  0x1f988b, 0x22a884, 0x35b779, 0x54c568, 0x7ad151, 0xa5db36, 0xd2e21b, 0xfde725,
].map((rgb) => [(rgb >> 16) / 255, ((rgb >> 8) & 255) / 255, (rgb & 255) / 255]);

/** Returns the colour scale as a CSS gradient, with the smallest value on the left. */
export const gradient = () =>
  `linear-gradient(to right, ${VIRIDIS.map((rgb) => `rgb(${rgb.map((c) => Math.round(255 * c)).join(' ')})`).join(', ')})`;

const ENDS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 45, 90, 180];

/** Returns a round number of degrees, not below `degrees`, at which the colour scale ends. */
export const scaleEnd = (degrees) => ENDS.find((end) => end >= degrees) ?? 180;

/** Formats degrees for people: about three digits, "0°" for a negligible error, and "–" if no error is known. */
export function degreesText(degrees) {
  if (!(degrees >= 0)) return '–';
  if (degrees < 0.0005) return '0°';
  return `${degrees < 0.1 ? degrees.toFixed(3) : degrees < 10 ? degrees.toFixed(2) : degrees.toFixed(1)}°`;
}
