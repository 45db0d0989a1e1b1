// This code is put inside the function that makes a module. It defines the names of CommonJS, which an ES module lacks.
var require = Module['require'], __dirname = '/';
