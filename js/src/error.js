/** An error of the program: its exit code and its message, which names the place. */
export class ChronormalError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'ChronormalError';
    this.code = code;
  }
}
