// The build puts this code before Emscripten's function that makes a module of the program. That function tests if the
// name `__filename` of CommonJS exists. Without this variable, bundlers would take the module for CommonJS.
var __filename;
