// The build puts this code inside the function that makes a module. The code defines the names of CommonJS, which an ES
// module lacks.
var require = Module['require'], __dirname = '/';
