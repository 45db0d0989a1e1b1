/** What the program refused, or could not do: its exit code and its own words, which name the place. */
export class ChronormalError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'ChronormalError';
    this.code = code;
  }
}
