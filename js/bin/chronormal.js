#!/usr/bin/env node
// The program on any system with Node.js: the same commands, messages and exit codes, on the files of this machine.
import { main } from '../src/cli.js';

process.exitCode = await main(process.argv.slice(2));
