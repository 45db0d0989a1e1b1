// Linked into the module in place of Emscripten's own: up to how many bytes its memory grows, which whoever makes a
// module may say. One page less than 4 GiB is the most that 32 bits can count.
mergeInto(LibraryManager.library, {
  emscripten_get_heap_max: function () {
    return Math.min(Module['memoryLimit'] || Infinity, 4294901760);
  },
});
