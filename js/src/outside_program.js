// The build puts this code before the function that makes a module. That function tests if the name `__filename` of
// CommonJS exists. If the name were not a variable, bundlers would take the module for CommonJS.
var __filename;
