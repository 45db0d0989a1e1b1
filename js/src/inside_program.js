// Stands inside the function that makes a module: what CommonJS has, for a file that is an ES module.
var require = Module['require'], __dirname = '/';
