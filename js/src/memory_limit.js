// Replaces Emscripten's own function in the module: returns the limit of its memory in bytes, which the caller that
// makes a module may set. One page less than 4 GiB is the most that 32 bits can count.
mergeInto(LibraryManager.library, {
  emscripten_get_heap_max: function () {
    return Math.min(Module['memoryLimit'] || Infinity, 4294901760);
  },
});
