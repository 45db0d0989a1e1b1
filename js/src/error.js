/** An error of the program, with its exit code, and its message, which names the place of the fault. */
export class ChronormalError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'ChronormalError';
    this.code = code;
  }
}
