// This code is put before the function that makes a module, which looks for this name of CommonJS: bundlers take the
// module for CommonJS unless the name is a variable.
var __filename;
