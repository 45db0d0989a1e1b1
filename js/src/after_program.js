export default createProgram;
