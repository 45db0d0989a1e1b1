import os

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, get, rmdir

required_conan_version = ">=2.0"


class ChronormalConan(ConanFile):
    name = "chronormal"
    description = "Exact normals of triangle meshes that deform between keyframes"
    license = "MIT"
    url = "https://github.com/conan-io/conan-center-index"
    homepage = "https://github.com/chronormal/chronormal"
    topics = ("normals", "mesh", "morph-targets", "blend-shapes", "gltf")
    package_type = "static-library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"fPIC": [True, False], "with_io": [True, False]}
    default_options = {"fPIC": True, "with_io": True}

    def layout(self):
        cmake_layout(self, src_folder="src")

    def requirements(self):
        self.requires("highway/1.2.0")
        if self.options.with_io:
            self.requires("draco/1.5.6")
            self.requires("meshoptimizer/0.20")
            self.requires("nlohmann_json/3.11.3")
            self.requires("pugixml/1.14")
            self.requires("zlib/[>=1.2.11 <2]")

    def validate(self):
        check_min_cppstd(self, 20)
        if self.settings.os != "Linux":
            raise ConanInvalidConfiguration("chronormal has been built for Linux alone")

    def source(self):
        get(self, **self.conan_data["sources"][self.version], strip_root=True)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["CHRONORMAL_IO"] = bool(self.options.with_io)
        toolchain.cache_variables["CHRONORMAL_PROGRAM"] = False
        toolchain.cache_variables["CHRONORMAL_C"] = False
        toolchain.generate()
        # The names by which chronormal looks for libraries, which are not those of all recipes.
        dependencies = CMakeDeps(self)
        for package, file, target in (
            ("highway", "hwy", "hwy::hwy"),
            ("draco", "draco", "draco::draco"),
            ("meshoptimizer", "meshoptimizer", "meshoptimizer::meshoptimizer"),
            ("nlohmann_json", "nlohmann_json", "nlohmann_json::nlohmann_json"),
            ("pugixml", "pugixml", "pugixml::pugixml"),
            ("zlib", "ZLIB", "ZLIB::ZLIB"),
        ):
            dependencies.set_property(package, "cmake_file_name", file)
            dependencies.set_property(package, "cmake_target_name", target)
        dependencies.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))
        cmake = CMake(self)
        cmake.install()
        for folder in ("lib/cmake", "lib/pkgconfig", "share"):
            rmdir(self, os.path.join(self.package_folder, folder))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "chronormal")
        core = self.cpp_info.components["core"]
        core.set_property("cmake_target_name", "chronormal::chronormal")
        core.set_property("pkg_config_name", "chronormal")
        core.libs = ["chronormal"]
        core.system_libs = ["m", "pthread"]
        core.requires = ["highway::highway"]
        if self.options.with_io:
            io = self.cpp_info.components["io"]
            io.set_property("cmake_target_name", "chronormal::chronormal_io")
            io.set_property("pkg_config_name", "chronormal_io")
            io.libs = ["chronormal_io"]
            io.requires = ["core", "draco::draco", "meshoptimizer::meshoptimizer", "nlohmann_json::nlohmann_json",
                           "pugixml::pugixml", "zlib::zlib"]
