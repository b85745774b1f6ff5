# Cross compiling for 64-bit ARM with Debian's compiler, against the libraries that scripts/arm unpacks;
# what is built for the target runs in qemu, tests and their discovery included.
#
# REPOSE_SYSROOT: the folder of the target's root file system, /usr/include and /usr/lib within.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

set(REPOSE_SYSROOT ${CMAKE_CURRENT_LIST_DIR}/../build/arm-sysroot/root CACHE PATH
    "The target's root file system")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES REPOSE_SYSROOT)
get_filename_component(CMAKE_SYSROOT ${REPOSE_SYSROOT} ABSOLUTE)
if(NOT IS_DIRECTORY ${CMAKE_SYSROOT}/usr/include)
  message(FATAL_ERROR "REPOSE_SYSROOT=${REPOSE_SYSROOT} holds no /usr/include of the target: scripts/arm unpacks one")
endif()
# Programs are those of this machine; headers, libraries and packages those of the target.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# FindHDF5 would ask this machine's h5cc where the library lies.
set(HDF5_C_COMPILER_EXECUTABLE "" CACHE FILEPATH "none: it is one of this machine")
list(APPEND CMAKE_INCLUDE_PATH /usr/include/hdf5/serial)
list(APPEND CMAKE_LIBRARY_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/hdf5/serial)

set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static;-L;${CMAKE_SYSROOT})
