// The build puts this code inside Emscripten's function that makes a module of the program. The code defines `require`
// and `__dirname`, names of CommonJS that an ES module lacks.
var require = Module['require'], __dirname = '/';
