# sfdae_docs: the API reference in HTML. The C headers have plain comments; a filter marks them for Doxygen.

find_package(Doxygen REQUIRED)
set(DOXYGEN_PROJECT_NAME sfdae)
set(DOXYGEN_OPTIMIZE_OUTPUT_FOR_C YES)
set(DOXYGEN_EXTRACT_ALL YES)
set(DOXYGEN_WARN_IF_UNDOCUMENTED NO)
set(DOXYGEN_GENERATE_LATEX NO)
set(DOXYGEN_MACRO_EXPANSION YES)
set(DOXYGEN_PREDEFINED "SFDAE_API=" "__GNUC__")
set(DOXYGEN_FILTER_PATTERNS [["*.h=sed -e 's|^/\* SPDX.*||' -e 's|^/\* |/** |' -e 's|\([;0-9)]\) */\* |\1 /**< |'"]])
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE README.md)
doxygen_add_docs(sfdae_docs include README.md WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
