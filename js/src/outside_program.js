// Stands before the function that makes a module, which asks for this name of CommonJS: bundlers take it for that unless it
// is a variable.
var __filename;
