// This code is put before the function that makes a module, which tests whether the name `__filename` of CommonJS
// exists. Bundlers would take the module for CommonJS if the name were not a variable.
var __filename;
